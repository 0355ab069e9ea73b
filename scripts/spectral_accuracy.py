#!/usr/bin/env python3
"""Measures how far colours are off by the number of bands, and what bands cost; prints the tables of docs/benchmarks/accuracy.md.

usage: scripts/spectral_accuracy.py TOOL FOLDER [--patches N]

For meshes/color_chart_d65.toml, color_chart_a.toml and cornell_box_spectra.toml it solves in linear RGB and in several
numbers of bands, and compares the colour of every patch with that of 200 bands: CIE dE00, seen beside a white of the
lamp's colour that is as bright as the brightest patch but the lamp. The same patches and form factors throughout.
FOLDER takes the results, and color_error.svg. Takes some minutes."""
import argparse
import json
import math
import pathlib
import subprocess

from read_vtp import read_vtp

MESHES = pathlib.Path(__file__).resolve().parent.parent / "meshes"
SCENES = {"color_chart_d65": "chart under D65", "color_chart_a": "chart under A", "cornell_box_spectra": "Cornell box"}
BANDS = ["rgb", "3", "6", "8", "16", "31", "81", "auto"]
REFERENCE = "200"
# Luminance 179 cd/m^2 for a radiance of 1, IEC 61966-2-1.
XYZ_OF_RGB = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]


def xyz_of(arrays):
    if "xyz" in arrays:
        return arrays["xyz"]
    return [tuple(179 * sum(m * v for m, v in zip(row, rgb)) for row in XYZ_OF_RGB) for rgb in arrays["radiance"]]


def lab(xyz, white):
    f = [t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29 for t in
         (max(value, 0) / of_white for value, of_white in zip(xyz, white))]
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


def difference(one, other):
    """CIEDE2000: Sharma, Wu and Dalal 2005, eqs. 2 to 22."""
    (L1, a1, b1), (L2, a2, b2) = one, other
    share = lambda c: math.sqrt(c**7 / (c**7 + 25.0**7))
    stretch = 1 + 0.5 * (1 - share((math.hypot(a1, b1) + math.hypot(a2, b2)) / 2))
    C1, C2 = math.hypot(stretch * a1, b1), math.hypot(stretch * a2, b2)
    h1, h2 = (math.degrees(math.atan2(b, stretch * a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    turn = (h2 - h1 + 180) % 360 - 180 if C1 * C2 else 0
    h = h1 + h2 if C1 * C2 == 0 else (h1 + turn / 2) % 360
    L, C = (L1 + L2) / 2, (C1 + C2) / 2
    cosine = lambda degrees: math.cos(math.radians(degrees))
    T = 1 - 0.17 * cosine(h - 30) + 0.24 * cosine(2 * h) + 0.32 * cosine(3 * h + 6) - 0.2 * cosine(4 * h - 63)
    dl = (L2 - L1) / (1 + 0.015 * (L - 50) ** 2 / math.sqrt(20 + (L - 50) ** 2))
    dc = (C2 - C1) / (1 + 0.045 * C)
    dh = 2 * math.sqrt(C1 * C2) * math.sin(math.radians(turn / 2)) / (1 + 0.015 * C * T)
    R = -2 * share(C) * math.sin(math.radians(60 * math.exp(-(((h - 275) / 25) ** 2))))
    return math.sqrt(max(dl * dl + dc * dc + dh * dh + R * dc * dh, 0))


def solved(tool, scene, bands, out, patches):
    """The cells' arrays, and the report."""
    name = out / f"{scene}_{bands}"
    subprocess.run(
        [tool, "solve", MESHES / f"{scene}.toml", "--bands", bands, "--patches", str(patches), "--no-error-bars", "-o",
         f"{name}.vtp", "--json", f"{name}.json", "--threads", "1"],
        check=True, capture_output=True)
    return read_vtp(f"{name}.vtp"), json.loads(pathlib.Path(f"{name}.json").read_text())


def seconds(report, stage):
    return sum(cost["cpu_seconds"] for cost in report["costs"] if cost["stage"] == stage)


def errors_of(arrays, reference, white, is_lamp):
    return [0 if lamp else difference(lab(a, white), lab(b, white))
            for a, b, lamp in zip(xyz_of(arrays), xyz_of(reference), is_lamp)]


def plot(curves, file):
    """dE00 over the number of bands, both by their logarithms."""
    width, height, left, top = 560, 360, 60, 20
    x = lambda n: left + (width - left - 150) * math.log(n / 3) / math.log(81 / 3)
    y = lambda e: top + (height - top - 50) * (1 - math.log10(max(e, 0.01) / 0.01) / 4)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="12">',
             f'<rect width="{width}" height="{height}" fill="white"/>']
    for power in range(-2, 3):
        parts.append(f'<line x1="{left}" x2="{x(81):.1f}" y1="{y(10.0**power):.1f}" y2="{y(10.0**power):.1f}" stroke="#ddd"/>'
                     f'<text x="{left - 8}" y="{y(10.0**power) + 4:.1f}" text-anchor="end">{10.0**power:g}</text>')
    for n in (3, 6, 8, 16, 31, 81):
        parts.append(f'<text x="{x(n):.1f}" y="{height - 30}" text-anchor="middle">{n}</text>')
    parts.append(f'<text x="{x(15):.1f}" y="{height - 10}" text-anchor="middle">bands</text>'
                 f'<text x="16" y="{y(1):.1f}" transform="rotate(-90 16 {y(1):.1f})" text-anchor="middle">dE00, worst patch</text>')
    for k, (name, points) in enumerate(curves.items()):
        colour = ["#0072b2", "#d55e00", "#009e73"][k]
        line = " ".join(f"{x(n):.1f},{y(e):.1f}" for n, e in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>'
                     f'<text x="{x(81) + 8:.1f}" y="{top + 20 + 18 * k}" fill="{colour}">{name}</text>')
        parts += [f'<circle cx="{x(n):.1f}" cy="{y(e):.1f}" r="3" fill="{colour}"/>' for n, e in points]
    file.write_text("\n".join(parts) + "\n</svg>\n")


def by_material(errors, arrays, areas, names):
    """(name, mean by area, worst)"""
    for k, name in enumerate(names):
        chosen = [i for i, (m,) in enumerate(arrays["material_id"]) if int(m) == k]
        if chosen:
            area = sum(areas[i][0] for i in chosen)
            yield name, sum(errors[i] * areas[i][0] for i in chosen) / area, max(errors[i] for i in chosen)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--patches", type=int, default=2000)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    curves = {}
    for scene, title in SCENES.items():
        reference, report = solved(arguments.tool.resolve(), scene, REFERENCE, arguments.folder, arguments.patches)
        cells = reference[2]
        names = [material["name"] for material in report["materials"]]
        lamp_names = [m["name"] for m in report["materials"] if any(v > 0 for v in m["exitance_W_m2"])]
        is_lamp = [names[int(m)] in lamp_names for (m,) in cells["material_id"]]
        xyz = xyz_of(cells)
        lamp = next(v for v, lit in zip(xyz, is_lamp) if lit)
        brightest = max(v[1] for v, lit in zip(xyz, is_lamp) if not lit)
        white = [value / lamp[1] * brightest for value in lamp]
        print(f"\n{title}: {len(is_lamp)} patches\n\n| bands | dE00, worst patch | mean by area | form factors | solver, CPU s |")
        print("|---|---|---|---|---|")
        areas = cells["area"]
        for bands in BANDS:
            (_, _, arrays), report = solved(arguments.tool.resolve(), scene, bands, arguments.folder, arguments.patches)
            errors = errors_of(arrays, cells, white, is_lamp)
            number = len(arrays["radiance"][0])
            mean = sum(e * a[0] for e, a in zip(errors, areas)) / sum(a[0] for a in areas)
            label = f"{number}, chosen for 1" if bands == "auto" else "linear RGB" if bands == "rgb" else bands
            print(f"| {label} | {max(errors):.3g} | {mean:.3g} | {seconds(report, 'form factors'):.2f} | {seconds(report, 'solve'):.3f} |")
            if bands.isdigit():
                curves.setdefault(title, []).append((int(bands), max(errors)))
            if bands == "rgb":
                in_rgb = list(by_material(errors, arrays, areas, names))
        print("\nlinear RGB by material, dE00, mean and worst: " +
              "; ".join(f"{name} {mean:.2g}, {worst:.2g}" for name, mean, worst in in_rgb))
    plot(curves, arguments.folder / "color_error.svg")


main()
