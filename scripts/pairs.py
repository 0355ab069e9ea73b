#!/usr/bin/env python3
"""Two builds of the tool side by side: CPU seconds of the Cornell box and the two rooms, in interleaved pairs.

usage: scripts/pairs.py OLD NEW [PAIRS] [-- OPTION ...]    OLD and NEW are tools; the options go to NEW alone, as
--no-contact-lines --no-merge where OLD has neither. Default: 12 pairs.
"""
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

MESHES = pathlib.Path(__file__).resolve().parent.parent / "meshes"


def cpu_seconds(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(words):
    options = words[words.index("--") + 1:] if "--" in words else []
    words = words[:words.index("--")] if "--" in words else words
    if len(words) not in (2, 3):
        sys.exit(__doc__)
    pairs = int(words[2]) if len(words) == 3 else 12
    with tempfile.TemporaryDirectory(prefix="patchlight-pairs-") as folder:
        for model in ("cornell_box", "two_rooms"):
            rest = ["solve", MESHES / f"{model}.obj", "--sides", "front", "--patches", "4000", "-o", f"{folder}/out.vtp"]
            seconds = [(cpu_seconds([words[0], *rest]), cpu_seconds([words[1], *rest, *options])) for _ in range(pairs)]
            ratios = sorted(new / old for old, new in seconds)
            print(f"{model}: {statistics.median(old for old, _ in seconds):.2f} and "
                  f"{statistics.median(new for _, new in seconds):.2f} CPU s; median of the ratios "
                  f"{statistics.median(ratios):.3f}, from {ratios[0]:.3f} to {ratios[-1]:.3f}")


main(sys.argv[1:])
