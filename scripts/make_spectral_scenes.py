#!/usr/bin/env python3
"""Writes the scenes with spectra in meshes/: a color chart in a gray box under illuminants D65 and A, and the Cornell
box with its measured paints and lamp; their spectra stand in meshes/spectra.

usage: scripts/make_spectral_scenes.py FOLDER [--check]

FOLDER has cie1931_2deg_xyz.csv, cie_d65.csv, colorchecker_ohta.csv, cornell_spectra.csv and cornell_lamp.csv. With
--check nothing is written, and it fails when a file differs."""

import argparse
import csv
import pathlib
import sys

from make_meshes import MESHES, Material, Model, box, grey

CHART_ORIGIN = "Reflectance of the Macbeth ColorChecker, Ohta 1997; from colour-science (BSD-3, commit 9d743142)."
CORNELL_ORIGIN = "Measured for the Cornell box by the Cornell University Program of Computer Graphics; from raysect (BSD-3, commit 5ed9a21b)."


def table(file):
    """Names of the columns, and the rows as numbers."""
    with open(file, newline="") as lines:
        rows = list(csv.reader(lines))
    return rows[0], [[float(cell) for cell in row] for row in rows[1:] if row]


def interpolated(knots, wavelength):
    """Linear, the end values beyond."""
    if wavelength <= knots[0][0]:
        return knots[0][1]
    for (w0, v0), (w1, v1) in zip(knots, knots[1:]):
        if wavelength <= w1:
            return v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0)
    return knots[-1][1]


def rgb_of(reflectance, folder):
    """Linear RGB under D65 (IEC 61966-2-1), within 0 and 1, to four digits: what a scene without spectra has."""
    observer = table(folder / "cie1931_2deg_xyz.csv")[1]
    d65 = [(row[0], row[1]) for row in table(folder / "cie_d65.csv")[1]]
    xyz, white = [0, 0, 0], 0
    for wavelength, *weights in observer:
        light = interpolated(d65, wavelength)
        white += light * weights[1]
        for k in range(3):
            xyz[k] += light * weights[k] * interpolated(reflectance, wavelength)
    x, y, z = (value / white for value in xyz)
    rgb = (
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    )
    return tuple(round(min(max(value, 0), 1), 4) for value in rgb)


def spectra_of(file):
    """(name, knots) of each column."""
    names, rows = table(file)
    for k, name in enumerate(names[1:], 1):
        yield name, [(row[0], row[k]) for row in rows]


def file_name(name):
    """"white 9.5 (0.05 D)" is white_9_5."""
    return name.split(" (")[0].replace(" ", "_").replace(".", "_")


def spectrum_text(knots, origin):
    lines = [f"# {origin}", "wavelength_nm,value"]
    return "\n".join(lines + [f"{w:g},{v:g}" for w, v in knots]) + "\n"


def color_chart(fields):
    """fields: (name, rgb) of the 24, row by row from the top left."""
    model = Model(
        "color_chart",
        [
            "A colour chart of 24 fields of 40 mm on a black board before the back wall of a grey box of 0.5 x 0.6 x 0.45 m,",
            "z up, metres. The lamp closes a hole in the ceiling. Their spectra stand in color_chart_*.toml.",
        ],
        [Material("wall", grey(0.5)), Material("board", grey(0.04)), Material("lamp", grey(0.5))]
        + [Material(name, rgb) for name, rgb in fields],
    )
    width, depth, height = 0.5, 0.6, 0.45
    model.group("walls")
    box(model, "wall", (0, 0, 0), (width, depth, height), sides="+x-x+y-y-z", inward=True)
    model.group("ceiling")
    xs, ys = [0, 0.1, 0.4, width], [0, 0.15, 0.35, depth]
    for i in range(3):
        for k in range(3):
            material = "lamp" if (i, k) == (1, 1) else "wall"
            model.group("lamp" if material == "lamp" else "ceiling")
            (a, b), (c, d) = xs[i : i + 2], ys[k : k + 2]
            model.face(material, (a, c, height), (a, d, height), (b, d, height), (b, c, height))
    chart(model, [name for name, rgb in fields], width, depth)
    return model


def chart(model, names, width, depth):
    """A slab of 20 mm whose front (-y) is a grid of fields and gaps."""
    size, gap, thick = 0.04, 0.006, 0.02
    total = 6 * size + 7 * gap, 4 * size + 5 * gap
    x0, z0 = round((width - total[0]) / 2, 4), 0.1
    low, high = (x0, depth - thick - 0.01, z0), (x0 + total[0], depth - 0.01, z0 + total[1])
    model.group("chart")
    box(model, "board", low, high, sides="+x-x+y+z-z")
    xs = [x0 + (k + 1) // 2 * gap + k // 2 * size for k in range(14)]
    zs = [z0 + (k + 1) // 2 * gap + k // 2 * size for k in range(10)]
    for i in range(13):
        for k in range(9):
            is_field = i % 2 == 1 and k % 2 == 1
            material = names[(3 - k // 2) * 6 + i // 2] if is_field else "board"
            (a, b), (c, d) = xs[i : i + 2], zs[k : k + 2]
            model.face(material, (a, low[1], c), (b, low[1], c), (b, low[1], d), (a, low[1], d))


def chart_scene(illuminant, fields):
    lines = [
        f"# The colour chart under CIE illuminant {illuminant}. Written by scripts/make_spectral_scenes.py.",
        "[[model]]",
        'file = "color_chart.obj"',
        'up = "z"',
        "",
        "[[material]]",
        'name = "lamp"',
        "radiance = 20",
        f'spectrum = "{illuminant}"',
    ]
    for name in fields:
        lines += ["", "[[material]]", f'name = "{name}"', f'reflectance = "spectra/{name}.csv"']
    lines += [
        "",
        "[[camera]]",
        "eye = [0.25, 0.02, 0.24]",
        "target = [0.25, 0.6, 0.2]",
        "field_of_view = 42",
        'name = "chart"',
    ]
    return "\n".join(lines) + "\n"


CORNELL_SCENE = """# The Cornell box with the measured spectra of its paints and of its lamp. Written by scripts/make_spectral_scenes.py.
[[model]]
file = "cornell_box.obj"
up = "y"

[[material]]
name = "white"
reflectance = "spectra/cornell_white.csv"

[[material]]
name = "red"
reflectance = "spectra/cornell_red.csv"

[[material]]
name = "green"
reflectance = "spectra/cornell_green.csv"

[[material]]
name = "light"
spectrum = "spectra/cornell_lamp.csv"
"""


def files_of(folder):
    """(path, text) of all that is written."""
    fields = list(spectra_of(folder / "colorchecker_ohta.csv"))
    model = color_chart([(file_name(name), rgb_of(knots, folder)) for name, knots in fields])
    script = pathlib.Path(__file__).name
    yield MESHES / "color_chart.obj", model.obj().replace("make_meshes.py", script)
    yield MESHES / "color_chart.mtl", model.mtl()
    for illuminant in ("D65", "A"):
        text = chart_scene(illuminant, [file_name(name) for name, knots in fields])
        yield MESHES / f"color_chart_{illuminant.lower()}.toml", text
    yield MESHES / "cornell_box_spectra.toml", CORNELL_SCENE
    for name, knots in fields:
        yield MESHES / "spectra" / f"{file_name(name)}.csv", spectrum_text(knots, CHART_ORIGIN)
    for name, knots in spectra_of(folder / "cornell_spectra.csv"):
        yield MESHES / "spectra" / f"cornell_{name}.csv", spectrum_text(knots, CORNELL_ORIGIN)
    ((name, knots),) = spectra_of(folder / "cornell_lamp.csv")
    yield MESHES / "spectra" / "cornell_lamp.csv", spectrum_text(knots, CORNELL_ORIGIN)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    differing = []
    for path, text in files_of(arguments.folder):
        if not arguments.check:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
        elif not path.exists() or path.read_text() != text:
            differing.append(path.name)
    if differing:
        sys.exit("these files are not what scripts/make_spectral_scenes.py writes: " + ", ".join(differing))


if __name__ == "__main__":
    main()
