#!/usr/bin/env python3
"""Writes twelve rooms in which accuracy is measured, as OBJ models.

usage: scripts/make_varied_rooms.py FOLDER
Meters, z up; each room stresses something else: see the comment in its file.
"""

import math
import pathlib
import sys

from make_meshes import Material, Model, box, grey

LAMP = (20, 20, 20)


def room_with(name, comment, size, materials=(), sides="+x-x+y-y+z-z", walls=0.6):
    """A room of this size with its corner at the origin."""
    surfaces = [Material("wall", grey(walls)), Material("floor", grey(0.3)), Material("ceiling", grey(0.8))]
    model = Model(name, [comment], [*surfaces, Material("lamp", grey(0.5), LAMP), *materials])
    model.group("room")
    box(model, "wall", (0, 0, 0), size, sides, inward=True, materials={"-z": "floor", "+z": "ceiling"})
    return model


def hang_lamp(model, centre, size, height):
    """A flat body that shines downward."""
    model.group("lamp")
    (x, y), (sx, sy) = centre, size
    low, high = (x - sx / 2, y - sy / 2, height), (x + sx / 2, y + sy / 2, height + 0.04)
    box(model, "ceiling", low, high, materials={"-z": "lamp"})


def stand(model, name, low, size, material="wall", turn=0.0):
    """A block turned about its middle."""
    model.group(name)
    middle = (low[0] + size[0] / 2, low[1] + size[1] / 2)
    block = Model("block", [], model.materials)
    box(block, material, (-size[0] / 2, -size[1] / 2, low[2]), (size[0] / 2, size[1] / 2, low[2] + size[2]))
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    points = [tuple(map(float, key)) for key in block.vertices]
    for line in block.lines:
        if line.startswith("f "):
            corners = [points[int(n) - 1] for n in line.split()[1:]]
            model.face(material, *[(middle[0] + c * x - s * y, middle[1] + s * x + c * y, z) for x, y, z in corners])


def empty():
    model = Model("empty", ["A closed room without anything in it, under a bright ceiling: no shadow edges."],
                  [Material("wall", grey(0.6)), Material("floor", grey(0.3)), Material("lamp", grey(0.5), LAMP)])
    model.group("room")
    box(model, "wall", (0, 0, 0), (4, 3, 2.5), inward=True, materials={"-z": "floor", "+z": "lamp"})
    return model


def blocks():
    model = room_with("blocks", "A closed room with two turned blocks on its floor.", (4, 3, 2.5))
    hang_lamp(model, (2, 1.5), (0.8, 0.8), 2.4)
    stand(model, "low_block", (0.6, 0.6, 0), (0.8, 0.8, 0.8), turn=17)
    stand(model, "high_block", (2.4, 1.2, 0), (0.7, 0.9, 1.5), turn=-22)
    return model


def open_side():
    model = room_with("open_side", "A room without the wall at y = 0: light escapes.", (4, 3, 2.5), sides="+x-x+y+z-z")
    hang_lamp(model, (2, 1.5), (1, 0.5), 2.4)
    stand(model, "block", (1.2, 1.4, 0), (0.9, 0.6, 1.1), turn=30)
    return model


def contact():
    model = room_with("contact", "A table on four legs and a board 2 cm above the floor: contact shadows.", (4, 3, 2.5))
    hang_lamp(model, (1.2, 1), (0.6, 0.6), 2.3)
    stand(model, "top", (1.8, 1, 0.7), (1.4, 0.8, 0.05))
    for x in (1.9, 3.05):
        for y in (1.05, 1.7):
            stand(model, "leg", (x, y, 0), (0.05, 0.05, 0.7))
    stand(model, "board", (0.5, 1.8, 0.02), (0.9, 0.6, 0.03))
    return model


def door_ajar():
    model = room_with("door_ajar", "Two rooms with a wall between them and a door ajar; the lamp is in one of them.",
                      (6, 3, 2.5))
    model.group("dividing_wall")
    box(model, "wall", (2.95, 0, 0), (3.05, 1, 2.5))
    box(model, "wall", (2.95, 1.9, 0), (3.05, 3, 2.5))
    box(model, "wall", (2.95, 1, 2.05), (3.05, 1.9, 2.5))
    angle = math.radians(25)
    model.group("door")
    door = 0.88
    ends = [(3.06, 1.01), (3.06 + door * math.sin(angle), 1.01 + door * math.cos(angle))]
    across = (0.04 * math.cos(angle), -0.04 * math.sin(angle))
    corners = [ends[0], (ends[0][0] + across[0], ends[0][1] + across[1]),
               (ends[1][0] + across[0], ends[1][1] + across[1]), ends[1]]
    low, high = 0.01, 2.04
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1]):
        model.face("wall", (x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high))
    model.face("wall", *[(x, y, high) for x, y in corners])
    model.face("wall", *[(x, y, low) for x, y in reversed(corners)])
    hang_lamp(model, (1.4, 1.5), (0.8, 0.8), 2.4)
    return model


def bright():
    model = room_with("bright", "All reflectances are 0.9 or more: light is reflected many times.", (3, 3, 2.5),
                      walls=0.95)
    for material in model.materials:
        material.kd = grey(0.95 if material.name != "floor" else 0.9)
    hang_lamp(model, (1.5, 1.5), (0.5, 0.5), 2.3)
    stand(model, "block", (0.8, 1.2, 0), (0.7, 0.7, 0.9), turn=40)
    return model


def tiny_lamp():
    model = room_with("tiny_lamp", "A lamp of 4 cm: sharp shadows.", (4, 3, 2.5))
    hang_lamp(model, (1.5, 1.3), (0.04, 0.04), 2.2)
    stand(model, "block", (2.2, 1.3, 0), (0.6, 0.6, 1), turn=12)
    return model


def thin_walls():
    model = room_with("thin_walls", "Partitions without thickness, seen from both sides.", (5, 4, 2.5))
    model.group("partitions")
    for x0, y0, x1, y1 in [(2, 0, 2, 2.6), (2, 2.6, 3.4, 2.6), (3.4, 1, 3.4, 2.6)]:
        corners = [(x0, y0, 0), (x1, y1, 0), (x1, y1, 1.9), (x0, y0, 1.9)]
        model.face("wall", *corners)
        model.face("ceiling", *reversed(corners))
    hang_lamp(model, (1, 2), (0.6, 1.2), 2.4)
    return model


def corridor():
    model = room_with("corridor", "A corridor of 20 x 2 m with a lamp near one end.", (20, 2, 2.5))
    hang_lamp(model, (1.5, 1), (1, 0.4), 2.4)
    stand(model, "cupboard", (8, 0.02, 0), (1.2, 0.5, 1.8))
    return model


def colors():
    materials = [Material("red", (0.63, 0.06, 0.05)), Material("green", (0.14, 0.45, 0.09)),
                 Material("warm", grey(0.7), (30, 18, 6)), Material("cool", grey(0.7), (4, 9, 22))]
    model = Model("colors", ["Red and green walls under a warm and a cool lamp."],
                  [Material("wall", (0.73, 0.72, 0.68)), *materials])
    model.group("room")
    box(model, "wall", (0, 0, 0), (3, 3, 3), inward=True, materials={"-x": "red", "+x": "green"})
    model.group("lamps")
    box(model, "wall", (0.4, 1, 2.9), (0.9, 2, 2.94), materials={"-z": "warm"})
    box(model, "wall", (2.1, 1, 2.9), (2.6, 2, 2.94), materials={"-z": "cool"})
    stand(model, "low_block", (1.7, 0.5, 0), (0.8, 0.8, 0.8), turn=17)
    stand(model, "high_block", (0.6, 1.5, 0), (0.8, 0.8, 1.6), turn=-18)
    return model


def slits():
    model = room_with("slits", "Two halves of a room with a wall of 20 slits between them, 2 % open.", (4, 2, 2))
    hang_lamp(model, (1, 1), (0.6, 0.6), 1.9)
    model.group("slit_wall")
    period, gap = 0.1, 0.002
    for k in range(20):
        y0, y1 = k * period + (gap / 2 if k else 0), (k + 1) * period - (gap / 2 if k < 19 else 0)
        corners = [(2, y0, 0), (2, y1, 0), (2, y1, 2), (2, y0, 2)]
        model.face("wall", *corners)
        model.face("wall", *reversed(corners))
    return model


def louvres():
    model = room_with("louvres", "A room lit by a glowing wall behind 40 tilted slats.", (4, 3, 2.5))
    for material in model.materials:
        if material.name == "lamp":
            material.ke = (2, 2, 2)
    model.group("lamp")
    model.face("lamp", (0.01, 0.5, 0.5), (0.01, 2.5, 0.5), (0.01, 2.5, 2.1), (0.01, 0.5, 2.1))
    model.group("slats")
    for k in range(40):
        z = 0.5 + 0.04 * k
        corners = [(0.1, 0.5, z), (0.13, 0.5, z + 0.03), (0.13, 2.5, z + 0.03), (0.1, 2.5, z)]
        model.face("ceiling", *corners)
        model.face("ceiling", *reversed(corners))
    return model


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for make in (empty, blocks, open_side, contact, door_ajar, bright, tiny_lamp, thin_walls, corridor, colors, slits,
                 louvres):
        model = make()
        (folder / f"{model.name}.obj").write_text(model.obj())
        (folder / f"{model.name}.mtl").write_text(model.mtl())


if __name__ == "__main__":
    main()
