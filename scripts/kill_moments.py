#!/usr/bin/env python3
"""Kills runs that write five files and a series at random moments, and looks at what is left.

usage: scripts/kill_moments.py TOOL [--moments N] [--seed N]

After each kill every file must be the older one or the whole new one; so must the series, whose .pvd names files that are
there. All must be of one run, or the kill fell between the first and the last of the renames, which is counted: then the
new ones are those that are renamed first. After one more run no temporary file is left.
"""
import argparse
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

from mutate import MATERIALS, POINTS, ROOM

# In the order in which they appear.
FILES = ("out.vtp", "out.ply", "out.png", "spots.csv", "out.json", "out.pvd")


def words(tool, brightness):
    return [tool, "solve", "room.obj", "-q", "--patches", "100", "--set", f"lamp.exitance={brightness}", "-o", "out.vtp", "-o",
            "out.ply", "--picture", "out.png", "--points", "spots.pts", "--points-output", "spots.csv", "--report",
            "out.json", "--series", "out.pvd"]


def state(folder):
    """The bytes of each file; of the series the names in the .pvd, each of which must be a whole file."""
    for entry in xml.etree.ElementTree.parse(folder / "out.pvd").getroot().iter("DataSet"):
        data = (folder / entry.get("file")).read_bytes()
        if not data.rstrip().endswith(b"</VTKFile>"):
            raise AssertionError(f"{entry.get('file')} is cut off")
    # The report has times in it, so that it differs from run to run; what it says of the model does not.
    return tuple((folder / name).read_bytes() if name != "out.json" else
                 (folder / name).read_text().split('"command_line": ')[1].split("\n")[0] for name in FILES)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=os.path.abspath)
    parser.add_argument("--moments", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    counts = {"old": 0, "new": 0, "between": 0}
    faults = []
    with tempfile.TemporaryDirectory(prefix="patchlight-kill-") as place:
        folder = pathlib.Path(place)
        for name, text in (("room.obj", ROOM), ("room.mtl", MATERIALS), ("spots.pts", POINTS)):
            (folder / name).write_text(text)
        whole = {}
        for brightness in (2, 1):
            begin = time.monotonic()
            subprocess.run(words(options.tool, brightness), cwd=folder, check=True)
            duration = time.monotonic() - begin
            whole[brightness] = state(folder)
        now, killed = 1, 0
        while killed < options.moments:
            wanted = 3 - now
            moment = chance.uniform(0, duration)
            process = subprocess.Popen(words(options.tool, wanted), cwd=folder)
            time.sleep(moment)
            process.kill()
            if process.wait() != -signal.SIGKILL:
                duration, now = moment, wanted  # faster than was thought
                continue
            killed += 1
            found = [file == new for file, new in zip(state(folder), whole[wanted])]
            whole_or_old = [file in both for file, *both in zip(state(folder), whole[1], whole[2])]
            if not all(whole_or_old) or sorted(found, reverse=True) != found:
                faults.append(f"moment {killed}: {dict(zip(FILES, found))}")
            counts["new" if all(found) else "between" if any(found) else "old"] += 1
            if all(found):
                now = wanted
            elif any(found):
                subprocess.run(words(options.tool, now), cwd=folder, check=True)
        subprocess.run(words(options.tool, 1), cwd=folder, check=True)
        left = [str(path.relative_to(folder)) for path in folder.rglob(".patchlight-*")]
        named = len(list(xml.etree.ElementTree.parse(folder / "out.pvd").getroot().iter("DataSet")))
        if left or named != len(list((folder / "out_series").iterdir())):
            faults.append(f"left behind: {left}, {named} files of the series named")
    print(f"kill_moments: {killed} kills within {duration:.2f} s of a run: {counts['old']} times all files old, {counts['new']} "
          f"times all new, {counts['between']} times between two renames; {len(faults)} faults")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
