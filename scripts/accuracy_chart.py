#!/usr/bin/env python3
"""Draws docs/figures/accuracy_chart.svg: error against CPU time in the Cornell box, of patchlight, Radiance and Cycles.

usage: scripts/accuracy_chart.py                       draws the chart from docs/figures/accuracy_chart.csv
       scripts/accuracy_chart.py --measure FOLDER      measures patchlight first and writes that file
FOLDER holds cornell.obj, cornell_reference.csv (irradiance at points, with standard errors) and
time_error_cornell.csv (CPU time and error of the other programs). PATCHLIGHT_TOOL names the tool to measure.
"""
import csv
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = ROOT / "docs/figures/accuracy_chart.csv"
CHART = ROOT / "docs/figures/accuracy_chart.svg"
PATCHES = (150, 500, 1500, 5000)
NAMES = {"cycles": "Cycles", "radiance": "Radiance, no cache", "radiance cached": "Radiance, ambient cache", "patchlight": "patchlight"}
COLORS = {"cycles": "#c47a00", "radiance": "#5b5b9a", "radiance cached": "#9a9ac8", "patchlight": "#0a7d5a"}


def measure(folder):
    """Rows of system, setting, CPU seconds and rms error relative to the mean, in percent."""
    tool = pathlib.Path(os.environ.get("PATCHLIGHT_TOOL", ROOT / "build/src/patchlight")).resolve()
    with open(folder / "cornell_reference.csv", encoding="utf-8") as file:
        points = [row for row in csv.DictReader(file) if row["flag"] == "0"]
    rows = []
    with tempfile.TemporaryDirectory() as name:
        scratch = pathlib.Path(name)
        (scratch / "points.txt").write_text(
            "".join(" ".join(p[k] for k in ("x", "y", "z", "nx", "ny", "nz")) + "\n" for p in points))
        for patches in PATCHES:
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([tool, "solve", folder / "cornell.obj", "--unit", "mm", "--sides", "front", "--patches", str(patches), "--samples", "16",
                            "--no-error-bars", "--quiet", "--points", "points.txt", "--points-output", "e.csv"], cwd=scratch, check=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            with open(scratch / "e.csv", encoding="utf-8") as file:
                found = list(csv.DictReader(file))
            errors = []
            for band in "rgb":
                pairs = [(float(a[f"E_{band}"]), float(b[f"E_{band}"])) for a, b in zip(found, points)]
                mean = sum(b for _, b in pairs) / len(pairs)
                errors.append(math.sqrt(sum((a - b) ** 2 for a, b in pairs) / len(pairs)) / mean)
            rows.append(("patchlight", f"{patches} patches", round(after.ru_utime - before.ru_utime, 2), round(100 * max(errors), 3)))
    own = [math.sqrt(sum(float(p[f"stderr_{b}"]) ** 2 for p in points) / len(points)) / (sum(float(p[f"E_{b}"]) for p in points) / len(points))
           for b in "rgb"]
    rows.append(("reference", "standard error of the reference itself", 0, round(100 * max(own), 3)))
    with open(folder / "time_error_cornell.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            cached = row["settings"].startswith("cached")
            rows.append((row["system"] + (" cached" if cached else ""), row["settings"], float(row["user_cpu_s"]), float(row["rms_error_pct"])))
    with open(DATA, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("system", "setting", "user_cpu_s", "rms_error_percent"))
        writer.writerows(rows)


def draw():
    with open(DATA, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    width, height, left, right, top, bottom = 640, 400, 66, 16, 30, 50
    x_low, x_high, y_low, y_high = -1, 3, -1, 2  # powers of ten

    def x(seconds):
        return left + (math.log10(seconds) - x_low) / (x_high - x_low) * (width - left - right)

    def y(percent):
        return top + (y_high - math.log10(percent)) / (y_high - y_low) * (height - top - bottom)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
           "<title>Error against CPU time in the Cornell box</title>", f'<rect width="{width}" height="{height}" fill="white"/>']
    for power in range(x_low, x_high + 1):
        at = x(10.0 ** power)
        out.append(f'<path d="M{at:.1f} {top}V{height - bottom}" stroke="#ddd"/><text x="{at:.1f}" y="{height - bottom + 18}" text-anchor="middle">{10.0 ** power:g}</text>')
    for power in range(y_low, y_high + 1):
        at = y(10.0 ** power)
        out.append(f'<path d="M{left} {at:.1f}H{width - right}" stroke="#ddd"/><text x="{left - 8}" y="{at + 4:.1f}" text-anchor="end">{10.0 ** power:g} %</text>')
    out.append(f'<text x="{(left + width - right) / 2}" y="{height - 10}" text-anchor="middle">CPU time, s</text>')
    out.append(f'<text x="{left}" y="18">rms error of the irradiance at about 500 points, relative to the mean</text>')
    for system, name in NAMES.items():
        places = sorted((x(float(r["user_cpu_s"])), y(float(r["rms_error_percent"]))) for r in rows if r["system"] == system)
        line = "L".join(f"{a:.1f} {b:.1f}" for a, b in places)
        out.append(f'<path d="M{line}" fill="none" stroke="{COLORS[system]}" stroke-width="2"/>')
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="4" fill="{COLORS[system]}"/>' for a, b in places]
        (a, b), anchor, shift = {"cycles": (places[0], "start", (9, -8)), "radiance": (places[-1], "end", (12, 22)),
                                 "radiance cached": (places[0], "start", (0, -12)), "patchlight": (places[-1], "start", (9, 5))}[system]
        out.append(f'<text x="{a + shift[0]:.1f}" y="{b + shift[1]:.1f}" text-anchor="{anchor}" fill="{COLORS[system]}" font-weight="bold">{name}</text>')
    own = y(next(float(r["rms_error_percent"]) for r in rows if r["system"] == "reference"))
    out.append(f'<path d="M{left} {own:.1f}H{width - right}" stroke="#999" stroke-dasharray="5 4"/>')
    out.append(f'<text x="{width - right}" y="{own + 16:.1f}" text-anchor="end" fill="#777">standard error of the reference</text>')
    out.append("</svg>")
    CHART.write_text("\n".join(out) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"] and len(sys.argv) == 3:
        measure(pathlib.Path(sys.argv[2]).resolve())
    elif len(sys.argv) > 1:
        sys.exit(__doc__)
    draw()
