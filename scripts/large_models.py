#!/usr/bin/env python3
"""Writes models that are large in one way each, in which quadratic geometry would take minutes.

usage: scripts/large_models.py FOLDER [--only NAME,NAME...]

All but the last stand in a closed room of 10 m with a lamp under its ceiling. The same files every time.
"""
import argparse
import math
import pathlib
import random

MATERIALS = """newmtl wall
Kd 0.6 0.6 0.6
newmtl thing
Kd 0.5 0.4 0.3
newmtl lamp
Kd 0 0 0
Ke 10 10 10
"""


class Obj:
    """Vertices and faces as lines of an OBJ file; a face names its corners from 0."""

    def __init__(self, libraries=("large.mtl",)):
        self.lines = [f"mtllib {name}\n" for name in libraries]
        self.vertices = 0
        self.room()
        self.lines.append("usemtl thing\n")

    def vertex(self, x, y, z):
        self.lines.append(f"v {x:.9g} {y:.9g} {z:.9g}\n")
        self.vertices += 1
        return self.vertices - 1

    def face(self, *corners):
        self.lines.append("f " + " ".join(str(c + 1) for c in corners) + "\n")

    def polygon(self, *points):
        self.face(*[self.vertex(*point) for point in points])

    def room(self):
        c = [self.vertex(x, y, z) for z in (0, 10) for y in (0, 10) for x in (0, 10)]
        self.lines.append("usemtl wall\n")
        for a, b, d, e in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)):
            self.face(c[a], c[b], c[d], c[e])
        self.lines.append("usemtl lamp\n")
        self.polygon((4, 4, 9.9), (4, 6, 9.9), (6, 6, 9.9), (6, 4, 9.9))


def identical(count):
    """One triangle again and again, with vertices of its own every time."""
    model = Obj()
    for _ in range(count):
        model.polygon((3, 3, 3), (5, 3, 3), (3, 5, 4))
    return model


def degenerate(count):
    """Triangles whose corners lie on one line."""
    model, chance = Obj(), random.Random(1)
    for _ in range(count):
        x, y, z = (chance.uniform(1, 9) for _ in range(3))
        model.polygon((x, y, z), (x + 0.25, y, z), (x + 0.5, y, z))
    return model


def on_one_edge(count):
    """Triangles that share an edge, like the leaves of a book."""
    model = Obj()
    low, high = model.vertex(5, 5, 2), model.vertex(5, 5, 8)
    for k in range(count):
        angle = 2 * math.pi * k / count
        model.face(low, high, model.vertex(5 + 3 * math.cos(angle), 5 + 3 * math.sin(angle), 5))
    return model


def intersecting(count):
    """Triangles of about 1 m at random places: each is crossed by many others."""
    model, chance = Obj(), random.Random(2)
    for _ in range(count):
        middle = [chance.uniform(1.5, 8.5) for _ in range(3)]
        model.polygon(*[[x + chance.uniform(-0.7, 0.7) for x in middle] for _ in range(3)])
    return model


def disc(count):
    """One round face that lies over the floor."""
    model = Obj()
    model.face(*[model.vertex(5 + 4 * math.cos(2 * math.pi * k / count), 5 + 4 * math.sin(2 * math.pi * k / count), 0.5)
                 for k in range(count)])
    return model


def cylinder(count):
    """A round column of so many sides from above the floor to below the lamp, with both lids."""
    model = Obj()
    rims = [[model.vertex(5 + 4 * math.cos(2 * math.pi * k / count), 5 + 4 * math.sin(2 * math.pi * k / count), z)
             for k in range(count)] for z in (0.5, 8)]
    model.face(*reversed(rims[0]))
    model.face(*rims[1])
    for k in range(count):
        following = (k + 1) % count
        model.face(rims[0][k], rims[0][following], rims[1][following], rims[1][k])
    return model


def overlapping(count):
    """Quadrilaterals in one plane, of which nearly every two overlap."""
    model, chance = Obj(), random.Random(3)
    for _ in range(count):
        x, y = chance.uniform(3.5, 6.5), chance.uniform(3.5, 6.5)
        a, b, turn = chance.uniform(1, 2), chance.uniform(1, 2), chance.uniform(0, math.pi)
        u = (a * math.cos(turn), a * math.sin(turn))
        v = (-b * math.sin(turn), b * math.cos(turn))
        model.polygon(*[(x + s * u[0] + t * v[0], y + s * u[1] + t * v[1], 1) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    return model


def libraries(count):
    """Statements that name material files, of which one is there."""
    return Obj(["large.mtl"] + [f"missing{k}.mtl" for k in range(count - 1)])


MODELS = {
    "identical_1M": ("a million identical faces", lambda: identical(1_000_000)),
    "degenerate_1M": ("a million faces without area", lambda: degenerate(1_000_000)),
    "one_edge_100k": ("100,000 triangles on one edge", lambda: on_one_edge(100_000)),
    "intersecting_100k": ("100,000 intersecting triangles", lambda: intersecting(100_000)),
    "disc_10000": ("a disc of 10,000 corners", lambda: disc(10_000)),
    "cylinder_10000": ("a cylinder of 10,000 sides", lambda: cylinder(10_000)),
    "overlapping_2000": ("2,000 overlapping quadrilaterals", lambda: overlapping(2_000)),
    "one_edge_20k": ("20,000 triangles on one edge", lambda: on_one_edge(20_000)),
    "intersecting_20k": ("20,000 intersecting triangles", lambda: intersecting(20_000)),
    "disc_200": ("a disc of 200 corners", lambda: disc(200)),
    "disc_400": ("a disc of 400 corners", lambda: disc(400)),
    "disc_2500": ("a disc of 2,500 corners", lambda: disc(2_500)),
    "overlapping_300": ("300 overlapping quadrilaterals", lambda: overlapping(300)),
    "libraries_20k": ("20,000 `mtllib` lines", lambda: libraries(20_000)),
}


def write(folder, name):
    (folder / "large.mtl").write_text(MATERIALS)
    path = folder / f"{name}.obj"
    with open(path, "w", encoding="ascii") as file:
        file.writelines(MODELS[name][1]().lines)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--only", type=lambda text: text.split(","), default=list(MODELS))
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    for name in options.only:
        print(write(options.folder, name))


if __name__ == "__main__":
    main()
