#!/usr/bin/env python3
"""Draws what level grids of sensors read as a map (SVG): a coloured square with its number for each sensor
that is not inside a wall.

usage: scripts/sensor_map.py SENSORS.csv MAP.svg [--column daylight_factor_percent]

SENSORS.csv is what patchlight solve writes for sensors. x goes to the right, y up, to scale; every group is drawn where
it stands. Colours change at round numbers, so that a map can be read without its legend.
"""
import argparse
import csv
import math
import pathlib
import xml.sax.saxutils

COLORS = ["#30123b", "#4662d7", "#36aaf9", "#1ae4b6", "#72fe5e", "#c8ef34", "#faba39", "#f66b19", "#ca2a04"]
STEPS = (1, 2, 5)  # times powers of ten
PIXELS = 26        # of a square


def limits(values):
    """Eight round numbers up to the largest value, the last below it."""
    decades = [step * 10.0**k for k in range(-6, 9) for step in STEPS]
    below = [x for x in decades if x < max(values)]
    return below[-len(COLORS) + 1:]


def rounded(value):
    digits = 0 if value >= 100 else 1 if value >= 1 else 2
    return f"{value:.{digits}f}"


def spacing(points):
    """The shortest distance between neighbours along x or y."""
    gaps = [b - a for k in (0, 1) for values in [sorted({round(p[k], 6) for p in points})]
            for a, b in zip(values, values[1:])]
    return min(gaps, default=1.0)


def color(value, bounds):
    k = sum(value >= bound for bound in bounds)
    return COLORS[k], "white" if k < 2 or k > 6 else "black"


def element(name, text=None, **attributes):
    inner = "".join(f" {key.replace('_', '-')}={xml.sax.saxutils.quoteattr(str(v))}" for key, v in attributes.items())
    return f"<{name}{inner}/>" if text is None else f"<{name}{inner}>{xml.sax.saxutils.escape(text)}</{name}>"


def squares(rows, bounds, scale, corner):
    for x, y, value, step in rows:
        fill, ink = color(value, bounds)
        left, top, edge = (x - step / 2 - corner[0]) * scale, (corner[1] - y - step / 2) * scale, step * scale
        yield element("rect", x=f"{left:.1f}", y=f"{top:.1f}", width=f"{edge:.1f}", height=f"{edge:.1f}", fill=fill,
                      stroke="white", stroke_width=0.5)
        yield element("text", rounded(value), x=f"{left + edge / 2:.1f}", y=f"{top + 0.62 * edge:.1f}", fill=ink,
                      font_size=9, text_anchor="middle")


def legend(bounds, top, title):
    yield element("text", title, x=0, y=top + 12, font_size=12)
    labels = [f"< {bounds[0]:g}"] + [f"{bound:g}" for bound in bounds]
    for k, label in enumerate(labels):
        yield element("rect", x=56 * k, y=top + 20, width=56, height=12, fill=COLORS[k])
        yield element("text", label, x=56 * k, y=top + 44, font_size=10)


def read(file, column):
    with open(file, newline="") as stream:
        rows = list(csv.DictReader(stream))
    if not rows or column not in rows[0]:
        raise SystemExit(f"error: {file}: has no column '{column}'")
    found = []
    for group in dict.fromkeys(row["group"] for row in rows):
        points = [(float(r["x"]), float(r["y"]), float(r[column])) for r in rows if r["group"] == group]
        step = spacing(points)
        found += [(x, y, value, step) for x, y, value in points if not math.isnan(value)]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sensors", type=pathlib.Path)
    parser.add_argument("map", type=pathlib.Path)
    parser.add_argument("--column", default="daylight_factor_percent")
    arguments = parser.parse_args()
    rows = read(arguments.sensors, arguments.column)
    bounds = limits([value for _, _, value, _ in rows]) or [1.0]
    scale = PIXELS / min(step for *_, step in rows)
    corner = min(x - step / 2 for x, _, _, step in rows), max(y + step / 2 for _, y, _, step in rows)
    width = max(math.ceil((max(x + step / 2 for x, _, _, step in rows) - corner[0]) * scale), 56 * (len(bounds) + 1))
    height = math.ceil((corner[1] - min(y - step / 2 for _, y, _, step in rows)) * scale)
    parts = [*squares(rows, bounds, scale, corner), *legend(bounds, height + 8, arguments.column.replace("_", " "))]
    arguments.map.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height + 60}" '
                             f'font-family="sans-serif">\n' + "\n".join(parts) + "\n</svg>\n")


if __name__ == "__main__":
    main()
