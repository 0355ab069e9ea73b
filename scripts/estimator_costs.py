#!/usr/bin/env python3
"""Prints the table of estimators and short cuts in docs/form_factors.md.

usage: scripts/estimator_costs.py [PATCHLIGHT]    PATCHLIGHT: the tool, build/src/patchlight if not given
"""
import array
import json
import math
import os
import pathlib
import sys
import tempfile

OPTIONS = ["--estimator auto", "--without hidden", "--without free", "--without far", "--estimator area",
           "--estimator contour", "--estimator point-polygon", "--estimator hemisphere --samples 4096"]


def values(file):
    """The numbers of an .npy file of doubles."""
    data = file.read_bytes()
    return array.array("d", data[10 + int.from_bytes(data[8:10], "little"):])


def main():
    tool = sys.argv[1] if len(sys.argv) > 1 else "build/src/patchlight"
    model = pathlib.Path(__file__).resolve().parent.parent / "meshes" / "two_rooms.obj"
    print("| options | rays, M | CPU s | raw row sums: rms error | mean |\n|---|---|---|---|---|")
    for options in OPTIONS:
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "room.ff"
            words = [tool, "form-factors", str(model), "--patches", "2000", "--no-closure", "-q", "-o", str(out), *options.split()]
            _, status, used = os.wait4(os.posix_spawnp(tool, words, os.environ), 0)
            if status != 0:
                sys.exit(f"error: {' '.join(words)} failed")
            sums = values(out / "raw_row_sum.npy")
            rays = json.loads((out / "info.json").read_text())["counts"]["shadow_rays"]
        rms = math.sqrt(sum((s - 1) ** 2 for s in sums) / len(sums))
        mean = sum(sums) / len(sums)
        print(f"| `{options}` | {rays / 1e6:.1f} | {used.ru_utime:.2g} | {rms:.1e} | {mean:.4f} |", flush=True)


if __name__ == "__main__":
    main()
