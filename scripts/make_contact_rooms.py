#!/usr/bin/env python3
"""Writes rooms in which faces touch, cross, or end close before others, as OBJ models with normals into the room.

usage: scripts/make_contact_rooms.py FOLDER
Each is a room of 4 x 3 x 2.5 m with a lamp of 1 x 0.4 m below the ceiling, but for those whose lamp is the hard case.
"""

import math
import pathlib
import sys

from make_meshes import Material, Model, box, grey, prism

SIZE = (4, 3, 2.5)


def lamp_at(model, height, up):
    (x0, y0), (x1, y1) = (1.5, 1.3), (2.5, 1.7)
    corners = [(x0, y0, height), (x1, y0, height), (x1, y1, height), (x0, y1, height)]
    model.face("lamp", *(corners if up else corners[::-1]))


def room(name, comment, lamp=(2.2, False)):
    materials = [Material("wall", grey(0.6)), Material("red", (0.6, 0.2, 0.1)), Material("lamp", grey(0), grey(10))]
    model = Model(name, [comment], materials)
    box(model, "wall", (0, 0, 0), SIZE, inward=True)
    lamp_at(model, *lamp)
    return model


def shelf():
    model = room("shelf", "a shelf 1 cm from the wall")
    box(model, "red", (1, 0.01, 0), (2, 0.31, 1.8))
    return model


def leg():
    model = room("leg", "a table with four legs of 2 cm")
    box(model, "red", (1, 1, 0.7), (2.4, 1.8, 0.73))
    for x in (1.02, 2.36):
        for y in (1.02, 1.76):
            box(model, "red", (x, y, 0), (x + 0.02, y + 0.02, 0.7), "+x-x+y-y")
    return model


def dividing_wall():
    model = room("dividing_wall", "a wall of 10 cm with a door on one floor polygon")
    box(model, "red", (1.2, 0, 0), (1.3, 1.2, 2.5), "+x-x+y")
    box(model, "red", (1.2, 2.1, 0), (1.3, 3, 2.5), "+x-x-y")
    box(model, "red", (1.2, 1.2, 2), (1.3, 2.1, 2.5), "+x-x-z")
    return model


def crossing_boxes():
    model = room("crossing_boxes", "two boxes that cross each other")
    box(model, "red", (1, 1, 0), (2.2, 1.5, 0.8))
    box(model, "wall", (1.4, 0.6, 0.2), (1.8, 2.1, 1.1))
    return model


def stairs():
    model = room("stairs", "a staircase of 20 steps along a wall")
    run, rise = 0.15, 0.1
    profile = [(0.5, 0), (3.5, 0)]
    for k in range(20):
        profile += [(3.5 - run * k, rise * (k + 1)), (3.5 - run * (k + 1), rise * (k + 1))]
    prism(model, "red", profile, lambda u, v, w: (u, 0.8 * (1 - w), v))
    return model


def column():
    model = room("column", "a column of 32 sides from the floor to the ceiling")
    corners = [(1 + 0.2 * math.cos(math.pi * k / 16), 0.8 + 0.2 * math.sin(math.pi * k / 16)) for k in range(32)]
    for k in range(32):
        (x0, y0), (x1, y1) = corners[k], corners[(k + 1) % 32]
        model.face("red", (x0, y0, 0), (x1, y1, 0), (x1, y1, 2.5), (x0, y0, 2.5))
    return model


def rug():
    model = room("rug", "a rug in the plane of the floor")
    model.face("red", (1, 0.8, 0), (2.6, 0.8, 0), (2.6, 2, 0), (1, 2, 0))
    return model


ROOMS = [
    shelf,
    leg,
    dividing_wall,
    crossing_boxes,
    stairs,
    column,
    rug,
    lambda: room("lamp_up", "a lamp 1 cm below the ceiling that shines on it", (2.49, True)),
    lambda: room("lamp_down", "a lamp 1 cm below the ceiling that shines down", (2.49, False)),
]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for make in ROOMS:
        model = make()
        (folder / f"{model.name}.obj").write_text(model.obj())
        (folder / f"{model.name}.mtl").write_text(model.mtl())
        print(f"{model.name}: {model.faces} polygons")


if __name__ == "__main__":
    main()
