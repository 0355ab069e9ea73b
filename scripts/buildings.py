#!/usr/bin/env python3
"""Buildings as they come: `patchlight init` and `patchlight solve` of each model, and a row of docs/models.md for it.

usage: scripts/buildings.py TOOL OUT MODEL [MODEL ...]    a model may be followed by options of solve: "house.xml --patches 8000"
Writes scene files, results, reports and pictures into the folder OUT.
"""
import json
import pathlib
import resource
import shlex
import subprocess
import sys


def row(tool, out, words):
    model, options = pathlib.Path(words[0]), words[1:]
    scene = out / f"{model.stem}.toml"
    scene.unlink(missing_ok=True)
    subprocess.run([tool, "init", model, "-o", scene], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    names = {option: out / f"{model.stem}{suffix}"
             for option, suffix in (("-o", ".vtp"), ("--picture", ".png"), ("--json", ".json"))}
    outputs = [word for pair in names.items() for word in pair]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([tool, "solve", scene, *outputs, *options], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 3):
        return f"| {model.name} | refused: {done.stderr.strip().splitlines()[-1]} |"
    report = json.loads(names["--json"].read_text())
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    error = next((line for line in done.stdout.splitlines() if line.startswith("estimated error")), "no error stated")
    return (f"| {model.name} {shlex.join(options)} | {report['input']['polygons']} | {report['mesh']['patches']} | "
            f"{seconds:.0f} | {after.ru_maxrss / 1e6:.2f} | {error} |")


def main(words):
    if len(words) < 3:
        sys.exit(__doc__)
    out = pathlib.Path(words[1])
    out.mkdir(parents=True, exist_ok=True)
    print("| model | polygons | patches | CPU s | GB so far | stated error |\n|---|---|---|---|---|---|")
    for model in words[2:]:
        print(row(words[0], out, shlex.split(model)), flush=True)


main(sys.argv[1:])
