#!/usr/bin/env python3
"""Runs all sub-commands but validate with two builds of the tool and compares all that they write, number by number.

usage: scripts/same_answers.py OLD_TOOL NEW_TOOL [--keep FOLDER] [--tolerance SHARE]

OLD_TOOL may be the folder `old` of an earlier run with --keep.

For changes of the code that are meant to leave the answers alone. Bytes are compared first; where they differ,
the numbers of JSON, CSV and text files, but for times, and the names of the differing values are printed. Arrays of .vtp
and numpy files have to be the same bytes. Printed text is not compared, and there is no daylight. The exit code is 1
when a number differs by more than SHARE (default 0: the same bits) of it. Takes about two minutes.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MESHES = ROOT / "meshes"

# Name, arguments; {out} is a prefix for files that are compared.
COMMANDS = [
    ("dense", "solve cornell_box.obj --patches 600 -o {out}.vtp --json {out}.json --threads 1"),
    ("parallel", "solve cornell_box.obj --patches 600 -o {out}.vtp --json {out}.json --threads 2"),
    ("both_sides", "solve two_rooms.obj --patches 700 --sides both -o {out}.vtp --json {out}.json"),
    ("on_demand", "solve cornell_box.obj --patches 400 --method on-demand --solver progressive -o {out}.vtp --json {out}.json"),
    ("accuracy", "solve two_rooms.obj --accuracy 5% -o {out}.vtp --json {out}.json"),
    ("interest", "solve two_rooms.obj --accuracy 8% --focus floor_oak -o {out}.vtp --json {out}.json"),
    ("error_bars", "solve cornell_box.obj --patches 500 --error-bars -o {out}.ply --json {out}.json"),
    ("picture", "solve cornell_box.obj --patches 500 --picture {out}.png --json {out}.json"),
    ("points", "solve cornell_box.obj --patches 500 --points points.txt --points-output {out}.csv --json {out}.json"),
    ("shooting", "solve two_rooms.obj --patches 600 --solver overshooting --tolerance 1e-4 -o {out}.vtp --json {out}.json"),
    ("check", "check two_rooms.obj --json {out}.json"),
    ("plan", "plan two_rooms.obj --json {out}.json"),
    ("form_factors", "form-factors cornell_box.obj --patches 400 -o {out}"),
    ("relight", "relight {before} -o {out}.vtp --json {out}.json"),
    ("compare", "compare cornell_box.obj --patches 300 -o {out}"),
    ("study", "study cornell_box.obj --patches 300 --sizes 2 --no-adaptive --no-estimators -o {out}"),
    ("verify", "verify cornell_box.obj --patches 300 --checked 16 --paths 512 --json {out}.json"),
]

# Values that may differ from run to run.
TIMES = re.compile(r"second|_s$|rays_per_second|rate_of_rays|command_line|version|threads|busy|memory|expected_seconds|expected_memory|cost|price|conclusion")


def run(tool, folder):
    """Exit codes and messages of all commands; their files are in `folder`."""
    for file in (file for file in MESHES.iterdir() if file.is_file()):
        shutil.copy(file, folder)
    (folder / "points.txt").write_text("0.2 0.2 0.2 0 0 1\n0.4 0.3 0.1 0 0 1\n0.3 0.4 0.5 1 0 0\n")
    answers = {}
    for name, arguments in COMMANDS:
        words = arguments.format(out=name, before="form_factors").split()
        done = subprocess.run([tool, *words], cwd=folder, capture_output=True, text=True, check=False)
        answers[name] = done.returncode
        if done.returncode not in (0, 3, 5):
            print(f"{name}: {tool} ends with {done.returncode}: {done.stderr.strip()[-300:]}")
    return answers


def leaves(value, path=""):
    """All values of a JSON document by their place in it."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            yield from leaves(inner, f"{path}[{k}]")
    else:
        yield path, value


def numbers_of(file):
    """Values by name where the file is text of numbers; None for other files."""
    if file.suffix == ".json":
        return {path: value for path, value in leaves(json.loads(file.read_text())) if not TIMES.search(path)}
    if file.suffix in (".csv", ".md", ".txt"):
        lines = file.read_text().splitlines()
        head = next((line for line in lines if not line.startswith("#")), "").split(",")
        return {f"{n}:{head[k] if k < len(head) else k}": value for n, line in enumerate(lines)
                for k, value in enumerate(line.split(","))
                if not TIMES.search(head[k] if k < len(head) else "") and not line.startswith("#")}
    return None


def apart(a, b):
    """How far two values are apart, as a share of the larger; 1 if one is not a number."""
    try:
        x, y = float(a), float(b)
    except (TypeError, ValueError):
        return 0 if a == b else 1
    return 0 if x == y or (x != x and y != y) else abs(x - y) / max(abs(x), abs(y))


def arrays_of(file):
    """The arrays of a .vtp file by name, as they stand there; all of another file under one name."""
    data = file.read_bytes()
    if file.suffix != ".vtp":
        return {"bytes": data}
    head, tail = data.split(b"<AppendedData", 1)
    tail = tail[tail.index(b"_") + 1:]
    places = [(name.decode(), int(offset))
              for name, offset in re.findall(rb'Name="([^"]*)"[^>]*?offset="(\d+)"', head)]
    ends = [offset for _, offset in places[1:]] + [len(tail)]
    return {name: tail[offset:end] for (name, offset), end in zip(places, ends) if not TIMES.search(name)}


def difference(old, new):
    """A sentence, and by how much; None when both files say the same."""
    arrays = arrays_of(old), arrays_of(new)
    if arrays[0] == arrays[1] or TIMES.search(old.stem):
        return None
    if old.suffix == ".vtp":
        names = [name for name in {**arrays[0], **arrays[1]} if arrays[0].get(name) != arrays[1].get(name)]
        return f"other arrays: {', '.join(names)}", 1
    first, second = numbers_of(old), numbers_of(new)
    if first is None:
        return f"other bytes, {old.stat().st_size} and {new.stat().st_size} of them", 1
    missing = sorted(set(first) ^ set(second))
    differing = [(apart(first[key], second[key]), key) for key in first if key in second]
    worst = max(differing, default=(0, ""))
    if missing:
        return f"values in one of them alone: {', '.join(missing[:5])}", 1
    if worst[0] > 0:
        many = sum(share > 0 for share, _ in differing)
        return f"{many} values differ; most {worst[1]}: {first[worst[1]]} and {second[worst[1]]}", worst[0]
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--tolerance", type=float, default=0)
    options = parser.parse_args()
    folder = options.keep or pathlib.Path(tempfile.mkdtemp())
    faults = 0
    sides = {"old": folder / "old", "new": folder / "new"}
    for side, tool in (("old", options.old), ("new", options.new)):
        if os.path.isdir(tool):
            sides[side] = pathlib.Path(tool)
            continue
        sides[side].mkdir(parents=True, exist_ok=True)
        codes = run(os.path.abspath(tool), sides[side])
        (sides[side] / "exit_codes.json").write_text(json.dumps(codes))
    files = sorted({file.relative_to(place) for place in sides.values() for file in place.rglob("*") if file.is_file()})
    for file in files:
        pair = sides["old"] / file, sides["new"] / file
        if not all(one.exists() for one in pair):
            found = "written by one of them alone", 1
        else:
            found = difference(*pair)
        if found and found[1] > options.tolerance:
            faults += 1
            print(f"{file}: {found[0]}")
    if not options.keep:
        shutil.rmtree(folder)
    print(f"{len(COMMANDS)} commands, {len(files)} files: {faults} differ")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
