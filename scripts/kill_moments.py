#!/usr/bin/env python3
"""Kills runs that write five files and a series at random moments, and checks the remaining files.

usage: scripts/kill_moments.py TOOL [--signal KILL|TERM|INT|HUP] [--moments N] [--seconds S] [--seed N]

After each KILL every file must be the older one or the whole new one; so must the series, whose .pvd names files that are
there. All must be of one run, or the kill fell between the first and the last of the renames, which is counted: then the
new ones are those that are renamed first. The other signals stop a run at the next step: it returns 128 plus the number of
the signal, or 0 if it has ended before; all files are whole, and views that were not ready are the older ones. A program
that is still being loaded ends by the signal itself, and all files are the older ones. A new solution of a stopped run
can be rendered. After one more run no temporary file is left.
"""
import argparse
import json
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


# Two lamps that give other colors, so that pictures differ, too.
LAMPS = {1: "3,2,1", 2: "1,2,3"}


def words(tool, lamp):
    return [tool, "solve", "room.obj", "-q", "--patches", "100", "--set", f"lamp.exitance={LAMPS[lamp]}", "-o", "out.vtp", "-o",
            "out.ply", "--picture", "out.png", "--size", "100x100", "--points", "spots.pts", "--points-output", "spots.csv",
            "--json", "out.json", "--series", "out.pvd"]


def check_series(folder):
    """The names in the .pvd are those of whole files."""
    for entry in xml.etree.ElementTree.parse(folder / "out.pvd").getroot().iter("DataSet"):
        data = (folder / entry.get("file")).read_bytes()
        if not data.rstrip().endswith(b"</VTKFile>"):
            raise AssertionError(f"{entry.get('file')} is cut off")


def fact(folder, name):
    """The contents of a file about its run, without the times."""
    data = (folder / name).read_bytes()
    if name == "out.vtp":
        return data.rstrip().endswith(b"</VTKFile>")
    return json.loads(data)["command_line"] if name == "out.json" else data


def state(folder):
    """Each file by its inode, which a rename changes, and its bytes."""
    return {name: ((folder / name).stat().st_ino, (folder / name).read_bytes()) for name in FILES}


def is_whole(name, data):
    """True if the file has its end."""
    if name.endswith(".json"):
        return isinstance(json.loads(data), dict)
    ends = {".vtp": b"</VTKFile>", ".pvd": b"</VTKFile>", ".png": b"IEND\xaeB`\x82", ".ply": b"", ".csv": b"\n"}
    return data.rstrip(b"\n" if name.endswith((".vtp", ".pvd")) else b"").endswith(ends[pathlib.Path(name).suffix])


def renamed(folder, before, whole, is_soft):
    """Which files are those of the run that was stopped. Fails when one is neither its nor the older one. A run that was
    stopped softly has solutions of its own, which are whole."""
    check_series(folder)
    found = []
    for name, now in state(folder).items():
        found.append(now[0] != before[name][0])
        is_new = is_whole(name, now[1]) if is_soft else fact(folder, name) == whole[name]
        if not is_new if found[-1] else now != before[name]:
            raise AssertionError(f"{name} is neither the older one nor the new one")
    if not is_soft and sorted(found, reverse=True) != found:
        raise AssertionError(f"not in the order of the renames: {dict(zip(FILES, found))}")
    return found


def require_usable(tool, folder, lamp):
    """The solution of a stopped run can be rendered."""
    with tempfile.TemporaryDirectory(prefix="patchlight-kill-") as place:
        render = [tool, "render", "room.obj", "-q", "--set", f"lamp.exitance={LAMPS[lamp]}", "--solution", "out.vtp", "--size",
                  "8x8", "-o", os.path.join(place, "x.png")]
        done = subprocess.run(render, cwd=folder, check=False, capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(f"out.vtp cannot be rendered: exit code {done.returncode}, {done.stderr.strip()}")


def wait_for_writing(process, folder):
    """Until the outputs are being written, or the run has ended."""
    while process.poll() is None and not any(folder.glob(".patchlight-*.partial")):
        time.sleep(0.001)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=os.path.abspath)
    parser.add_argument("--signal", choices=("KILL", "TERM", "INT", "HUP"), default="KILL")
    parser.add_argument("--moments", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="no further kill after so long")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    sent = signal.Signals[f"SIG{options.signal}"]
    stopped = -sent if sent == signal.SIGKILL else 128 + sent
    if signal.getsignal(sent) == signal.SIG_IGN:
        signal.signal(sent, signal.SIG_DFL)  # nohup and background jobs of scripts ignore it, and so would the tool
    counts = {"old": 0, "new": 0, "between": 0}
    faults = []
    with tempfile.TemporaryDirectory(prefix="patchlight-kill-") as place:
        folder = pathlib.Path(place)
        for name, text in (("room.obj", ROOM), ("room.mtl", MATERIALS), ("spots.pts", POINTS)):
            (folder / name).write_text(text)
        whole, duration, writing = {}, 0, 0
        for lamp in (2, 1):
            begin = time.monotonic()
            process = subprocess.Popen(words(options.tool, lamp), cwd=folder)
            wait_for_writing(process, folder)
            written_from = time.monotonic()
            if process.wait() != 0:
                raise SystemExit("the run to be killed fails by itself")
            end = time.monotonic()
            duration, writing = end - begin, end - written_from
            whole[lamp] = {name: fact(folder, name) for name in FILES}
        now, killed, ended, usable = 1, 0, 0, 0
        start = time.monotonic()
        while killed < options.moments and time.monotonic() - start < options.seconds:
            wanted = 3 - now
            before = state(folder)
            process = subprocess.Popen(words(options.tool, wanted), cwd=folder)
            # Every second one while files are written.
            if (killed + ended) % 2 == 0:
                time.sleep(chance.uniform(0, duration))
            else:
                wait_for_writing(process, folder)
                time.sleep(chance.uniform(0, 1.2 * writing))
            process.send_signal(sent)
            code = process.wait()
            if code not in (0, stopped, -sent):
                faults.append(f"moment {killed + 1}: exit code {code}")
                break
            if code == 0:
                ended, now = ended + 1, wanted  # faster than was thought
                continue
            killed += 1
            try:
                found = renamed(folder, before, whole[wanted], sent != signal.SIGKILL)
                if code == -sent != stopped and any(found):
                    raise AssertionError("the signal has ended a run that wrote files")
                if sent != signal.SIGKILL and found[0]:
                    require_usable(options.tool, folder, wanted)
                    usable += 1
            except AssertionError as error:
                faults.append(f"moment {killed}: {error}")
                break
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
    print(f"kill_moments: {killed} kills, half of them within {duration:.2f} s of a run and half within the {writing:.2f} s in "
          f"which it writes: {counts['old']} times all files old, {counts['new']} times all new, {counts['between']} times "
          f"between two renames; {usable} new solutions of stopped runs rendered; {ended} runs ended before; "
          f"{len(faults)} faults")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
