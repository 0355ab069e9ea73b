#!/usr/bin/env python3
"""Compares irradiances behind panes, sheets and in mirrors with closed forms and with an unrelated program.

usage: scripts/surfaces_reference.py TOOL FOLDER [--patches 10000] [--threads 2]

FOLDER has scene files with sensors, NAME.toml, and NAME.csv with what their irradiances are: E_r,E_g,E_b with standard
errors stderr_r,stderr_g,stderr_b, and exact_r,exact_g,exact_b where a closed form is known; lines whose flag is not `ok`
are left out. Sensors are told apart by their names, of which a line each is printed: the median of what all bands are
off, relative, and the root mean square of it, relative to the mean; the standard errors of the reference in the same
way. When there is no such folder nothing is done: it is not part of this repository.
"""
import argparse
import csv
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

CASES = ["pane_black_clear", "pane_black_coloured", "daylight_black_over", "daylight_overcast", "daylight_clear_dec",
         "two_rooms_clear", "mirror_black", "sheet_black"]
BANDS = "rgb"
# What the scene files do not set.
SETTINGS = {"pane_black_coloured": ["--set", "pane.transmittance=0.9,0.5,0.2"],
            "sheet_black": ["--set", "sheet.diffuse_transmittance=0.4"]}


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def readings_of(tool, scene, options):
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(folder) / "points.csv"
        subprocess.run([tool, "solve", scene.name, "--patches", str(options.patches), "--threads", str(options.threads),
                        "--points-output", str(output), *SETTINGS.get(scene.stem, [])], cwd=scene.parent, check=True, capture_output=True)
        return rows_of(output)


class Group:
    """Sensors of one name."""

    def __init__(self):
        self.expected, self.off, self.error = [], [], []

    def add(self, reading, reference):
        for band in BANDS:
            is_exact = bool(reference.get("exact_" + band))
            expected = float(reference["exact_" + band if is_exact else "E_" + band])
            self.expected.append(expected)
            self.off.append(float(reading["E_" + band]) - expected)
            self.error.append(0 if is_exact else float(reference["stderr_" + band]))

    def columns(self):
        mean = statistics.fmean(self.expected)
        if mean == 0:
            return f"{len(self.off) // len(BANDS)} | dark, off by {max(map(abs, self.off)):.2g} W/m² | | | | "
        lit = [k for k, value in enumerate(self.expected) if value > 0]
        relative = [100 * abs(values[k]) / self.expected[k] for values in (self.off, self.error) for k in lit]
        rms = [100 * math.sqrt(statistics.fmean(v * v for v in values)) / mean for values in (self.off, self.error)]
        return (f"{len(self.off) // len(BANDS)} | {statistics.median(relative[:len(lit)]):.2f} | {rms[0]:.2f} | "
                f"{100 * statistics.fmean(self.off) / mean:+.2f} | {statistics.median(relative[len(lit):]):.2f} | "
                f"{rms[1]:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--patches", type=int, default=10000)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    if not options.folder.is_dir():
        print(f"skipped: {options.folder} is not there")
        return
    tool = str(pathlib.Path(options.tool).resolve())
    print("| case | sensors | number | median, % | rms of the mean, % | mean, % | standard error: median, % | rms, % |")
    print("|---|---|---|---|---|---|---|---|")
    for case in CASES:
        groups = {}
        readings = readings_of(tool, (options.folder / (case + ".toml")).resolve(), options)
        for reading, reference in zip(readings, rows_of(options.folder / (case + ".csv")), strict=True):
            if reference["flag"] == "ok":
                groups.setdefault(reference["sensor"], Group()).add(reading, reference)
                groups.setdefault("all", Group()).add(reading, reference)
        if len(groups) == 2:
            del groups["all"]
        for name, group in groups.items():
            print(f"| {case} | {name} | {group.columns()} |")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
