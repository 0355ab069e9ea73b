#!/usr/bin/env python3
"""How the time of `patchlight check` grows with the size of a model, for ten kinds of things that a model has many of.

usage: tests/benchmarks/growth.py TOOL [--most N] [--only KIND]
Prints a table in Markdown: CPU seconds for N / 16, N / 4 and N things, and the exponent p of time ~ n^p between the last
two. The time of a model with one thing is subtracted.
"""
import argparse
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

GBXML = ('<gbXML xmlns="http://www.gbxml.org/schema" lengthUnit="Meters" useSIUnitsForResults="true">'
         '<Campus id="c"><Building id="b">')
PIXEL = b"P6\n1 1\n255\n\x80\x80\x80"
WALL_SPACE = '<Space id="s0"><Name>Room</Name></Space></Building>'


def triangles(count, before="", named=lambda k: ""):
    """An OBJ file of separate triangles in one plane."""
    lines = [before]
    for k in range(count):
        x, y = k % 400, k // 400
        lines.append(f"{named(k)}v {x} {y} 0\nv {x + .9} {y} 0\nv {x + .9} {y + .9} 0\nf -3 -2 -1\n")
    return "".join(lines)


def polygon(points):
    corners = "".join("<CartesianPoint>" + "".join(f"<Coordinate>{c}</Coordinate>" for c in point) + "</CartesianPoint>"
                      for point in points)
    return f"<PlanarGeometry><PolyLoop>{corners}</PolyLoop></PlanarGeometry>"


def materials(folder, count):
    (folder / "m.mtl").write_text("".join(f"newmtl m{k}\nKd .5 .5 .{k % 9 + 1}\n" for k in range(count)))
    (folder / "m.obj").write_text(triangles(count, "mtllib m.mtl\n", lambda k: f"usemtl m{k}\n"))
    return "m.obj"


def names(folder, count):
    spaces = "".join(f'<Space id="s{k}"><Name>Room</Name></Space>' for k in range(count))
    floors = "".join(f'<Surface id="f{k}" surfaceType="InteriorFloor"><AdjacentSpaceId spaceIdRef="s{k}"/>' +
                     polygon([(2 * (k % 100) + x, 2 * (k // 100) + y, 0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]) +
                     "</Surface>" for k in range(count))
    (folder / "m.xml").write_text(f"{GBXML}{spaces}</Building>{floors}</Campus></gbXML>")
    return "m.xml"


def holes(folder, count):
    columns = math.ceil(math.sqrt(count))
    windows = []
    for k in range(count):
        x, z = k % columns, k // columns
        corners = [[x + .2, 0, z + .2], [x + .8, 0, z + .2], [x + .8, 0, z + .8], [x + .2, 0, z + .8]]
        windows.append({"type": "Aperture", "identifier": f"a{k}", "properties": {"type": "AperturePropertiesAbridged"},
                        "geometry": {"type": "Face3D", "boundary": corners},
                        "boundary_condition": {"type": "Outdoors"}})
    wall = {"type": "Face", "identifier": "w", "face_type": "Wall", "boundary_condition": {"type": "Outdoors"},
            "properties": {"type": "FacePropertiesAbridged"}, "apertures": windows,
            "geometry": {"type": "Face3D",
                         "boundary": [[0, 0, 0], [columns, 0, 0], [columns, 0, columns], [0, 0, columns]]}}
    (folder / "m.hbjson").write_text(json.dumps({"type": "Model", "identifier": "m", "units": "Meters",
                                                 "orphaned_faces": [wall],
                                                 "properties": {"type": "ModelProperties"}}))
    return "m.hbjson"


def notches(folder, count):
    openings = "".join(f'<Opening id="o{k}" openingType="FixedWindow">' +
                       polygon([(k + .2, 0, 0), (k + .8, 0, 0), (k + .8, 0, 1), (k + .2, 0, 1)]) + "</Opening>"
                       for k in range(count))
    wall = polygon([(0, 0, 0), (count, 0, 0), (count, 0, 3), (0, 0, 3)])
    (folder / "m.xml").write_text(f'{GBXML}{WALL_SPACE}<Surface id="f0" surfaceType="ExteriorWall"><AdjacentSpaceId '
                                  f'spaceIdRef="s0"/>{wall}{openings}</Surface></Campus></gbXML>')
    return "m.xml"


def sheets(folder, count):
    (folder / "m.obj").write_text(triangles(count, named=lambda k: f"g a{k} b{k}\no o{k}\n"))
    return "m.obj"


def instances(folder, count):
    copies = "".join(f'<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="{k % 400 * 3}" '
                     f'y="{k // 400 * 3}"/></transform></shape>' for k in range(count))
    (folder / "m.xml").write_text('<scene version="3.0.0"><shape type="shapegroup" id="g"><shape type="rectangle">'
                                  f'<bsdf type="diffuse"/></shape></shape>{copies}</scene>')
    return "m.xml"


def lamps(folder, count):
    (folder / "m.mtl").write_text("newmtl lamp\nKd .5 .5 .5\nKe 1 1 1\n")
    (folder / "m.obj").write_text(triangles(count, "mtllib m.mtl\nusemtl lamp\n"))
    return "m.obj"


def room(folder):
    (folder / "room.obj").write_text("v 0 0 0\nv 400 0 0\nv 400 400 0\nv 0 400 0\nf 1 2 3 4\n")
    return 'unit = "m"\nup = "z"\n[[model]]\nfile = "room.obj"\n'


def luminaires(folder, count):
    text = "".join(f'[[luminaire]]\nkind = "point"\nlumens = 100\nposition = [{k % 400}.5, {k // 400}.5, 1]\n'
                   for k in range(count))
    (folder / "m.toml").write_text(room(folder) + text)
    return "m.toml"


def sensors(folder, count):
    (folder / "s.pts").write_text("".join(f"{k % 400}.5 {k // 400}.5 1 0 0 1\n" for k in range(count)))
    (folder / "m.toml").write_text(room(folder) + '[[sensors]]\nname = "s"\nfile = "s.pts"\n')
    return "m.toml"


def textures(folder, count):
    (folder / "p.ppm").write_bytes(PIXEL)
    (folder / "m.mtl").write_text("".join(f"newmtl m{k}\nmap_Kd p.ppm\n" for k in range(count)))
    (folder / "m.obj").write_text(triangles(count, "mtllib m.mtl\nvt 0 0\nvt 1 0\nvt 1 1\n", lambda k: f"usemtl m{k}\n")
                                  .replace("f -3 -2 -1", "f -3/1 -2/2 -1/3"))
    return "m.obj"


KINDS = (materials, names, holes, notches, sheets, instances, lamps, luminaires, sensors, textures)


def seconds(tool, write, count):
    """CPU seconds of a check, and what was wrong with it, if anything."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        model = write(folder, count)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([tool, "check", model], cwd=folder, capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        error = "" if done.returncode == 0 else f" (exit {done.returncode}: {done.stderr.strip()[:160]})"
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, error


def main():
    options = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    options.add_argument("tool")
    options.add_argument("--most", type=int, default=100_000)
    options.add_argument("--only")
    given = options.parse_args()
    tool = os.path.abspath(given.tool)
    sizes = [given.most // 16, given.most // 4, given.most]
    print(f"| kind | {' | '.join(f'{n:,}' for n in sizes)} | exponent |\n|---|---|---|---|---|")
    for write in KINDS:
        if given.only not in (None, write.__name__):
            continue
        least, _ = seconds(tool, write, 1)
        times, errors = zip(*(seconds(tool, write, n) for n in sizes))
        above = [max(t - least, 0.01) for t in times]
        exponent = math.log(above[2] / above[1]) / math.log(sizes[2] / sizes[1])
        shown = " | ".join(f"{t:.2f}" for t in times)
        print(f"| {write.__name__} | {shown} | {exponent:.2f}{errors[2]} |")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
