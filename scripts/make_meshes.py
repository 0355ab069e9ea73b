#!/usr/bin/env python3
"""Writes the models in meshes/. Run without arguments to write them, with --check to compare them with the files."""

import argparse
import math
import pathlib
import sys

MESHES = pathlib.Path(__file__).resolve().parent.parent / "meshes"
SCRIPT = pathlib.Path(sys.argv[0]).name


class Material:
    """Kd is the reflectance, Ke the emitted radiance in W/(m^2 sr), both linear RGB."""

    def __init__(self, name, kd, ke=(0, 0, 0)):
        self.name, self.kd, self.ke = name, kd, ke


class Model:
    """Faces in groups; vertices at the same place are written once."""

    def __init__(self, name, comment, materials):
        self.name, self.comment, self.materials = name, comment, materials
        self.vertices = {}
        self.lines = []
        self.faces = 0
        self.last_material = None

    def group(self, name):
        self.lines.append(f"g {name}")

    def face(self, material, *corners):
        """A polygon whose corners run counter-clockwise seen from its front."""
        assert material in [m.name for m in self.materials]
        if material != self.last_material:
            self.lines.append(f"usemtl {material}")
            self.last_material = material
        numbers = [self.vertices.setdefault(tuple(number(x) for x in c), len(self.vertices) + 1) for c in corners]
        self.lines.append("f " + " ".join(map(str, numbers)))
        self.faces += 1

    def obj(self):
        head = [f"# {line}" for line in self.comment]
        head.append(f"# {self.faces} polygons, {len(self.vertices)} vertices. Written by scripts/{SCRIPT}")
        head.append(f"mtllib {self.name}.mtl")
        vertices = ["v " + " ".join(v) for v in self.vertices]
        return "\n".join(head + vertices + self.lines) + "\n"

    def mtl(self):
        lines = [f"# Materials of {self.name}.obj: Kd reflectance, Ke emitted radiance in W/(m^2 sr), linear RGB"]
        for m in self.materials:
            lines += ["", f"newmtl {m.name}", "Kd " + spectrum(m.kd), "Ke " + spectrum(m.ke)]
        return "\n".join(lines) + "\n"


def number(x):
    """Lengths to a tenth of a millimeter and no tails of zeros."""
    text = f"{x:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def spectrum(values):
    return " ".join(f"{v:.17g}" if v != round(v, 6) else f"{v:g}" for v in values)


def grey(value):
    return (value, value, value)


def box(model, material, low, high, sides="+x-x+y-y+z-z", inward=False, materials=None):
    """The named sides of an axis-aligned box, normals outward by default; `materials` overrides single sides."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    quads = {
        "-x": [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
        "+x": [(x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1)],
        "-y": [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
        "+y": [(x0, y1, z0), (x0, y1, z1), (x1, y1, z1), (x1, y1, z0)],
        "-z": [(x0, y0, z0), (x0, y1, z0), (x1, y1, z0), (x1, y0, z0)],
        "+z": [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
    }
    for side in [sides[k : k + 2] for k in range(0, len(sides), 2)]:
        corners = quads[side][::-1] if inward else quads[side]
        model.face((materials or {}).get(side, material), *corners)


def prism(model, material, profile, place):
    """A closed solid: a profile, counter-clockwise in its own plane (u, v), extruded from w = 0 to w = 1.

    `place(u, v, w)` is the position; it must keep right-handedness.
    """
    model.face(material, *[place(u, v, 1) for u, v in profile])
    model.face(material, *[place(u, v, 0) for u, v in reversed(profile)])
    for (u0, v0), (u1, v1) in zip(profile, profile[1:] + profile[:1]):
        model.face(material, place(u0, v0, 0), place(u1, v1, 0), place(u1, v1, 1), place(u0, v0, 1))


def cornell_box():
    model = Model(
        "cornell_box",
        [
            "The Cornell box, y up, metres; the front (z = 0) is open, the lamp closes a hole in the ceiling.",
            "Geometry: measured data of the Cornell University Program of Computer Graphics,",
            "https://www.graphics.cornell.edu/online/box/data.html, with the walls made exactly rectangular",
            "(552.8 x 548.8 x 559.2 mm). The RGB reflectances and the lamp's radiance are the customary ones,",
            "not the measured spectra. Normals point into the box and out of the blocks, which have no bottoms.",
        ],
        [
            Material("white", (0.725, 0.71, 0.68)),
            Material("red", (0.63, 0.065, 0.05)),
            Material("green", (0.14, 0.45, 0.091)),
            Material("light", grey(0.78), (17, 12, 4)),
        ],
    )
    x1, y1, z1 = 0.5528, 0.5488, 0.5592
    model.group("floor")
    model.face("white", (0, 0, z1), (x1, 0, z1), (x1, 0, 0), (0, 0, 0))
    model.group("ceiling")
    xs, zs = [0, 0.213, 0.343, x1], [0, 0.227, 0.332, z1]
    for i in range(3):
        for k in range(3):
            a, b, c, d = xs[i], xs[i + 1], zs[k], zs[k + 1]
            material = "light" if (i, k) == (1, 1) else "white"
            if material == "light":
                model.group("light")
            model.face(material, (a, y1, c), (b, y1, c), (b, y1, d), (a, y1, d))
            if material == "light":
                model.group("ceiling")
    model.group("back_wall")
    model.face("white", (0, 0, z1), (0, y1, z1), (x1, y1, z1), (x1, 0, z1))
    model.group("left_wall")
    model.face("red", (x1, 0, 0), (x1, 0, z1), (x1, y1, z1), (x1, y1, 0))
    model.group("right_wall")
    model.face("green", (0, 0, z1), (0, 0, 0), (0, y1, 0), (0, y1, z1))
    block(model, "short_block", 0.165, [(0.130, 0.065), (0.082, 0.225), (0.240, 0.272), (0.290, 0.114)])
    block(model, "tall_block", 0.330, [(0.423, 0.247), (0.265, 0.296), (0.314, 0.456), (0.472, 0.406)])
    return model


def block(model, name, height, footprint):
    """Top and sides of a block, y up; the footprint (x, z) runs counter-clockwise seen from above."""
    model.group(name)
    model.face("white", *[(x, height, z) for x, z in footprint])
    for (x0, z0), (x1, z1) in zip(footprint, footprint[1:] + footprint[:1]):
        model.face("white", (x0, height, z0), (x0, 0, z0), (x1, 0, z1), (x1, height, z1))


def furnace_cube():
    model = Model(
        "furnace_cube",
        [
            "Furnace: a closed cube of 1 m, normals inward, z up. Reflectance 0.5 and exitance 0.5 = 1 - 0.5 W/m^2",
            "everywhere, so the radiosity is exactly 1 W/m^2.",
        ],
        [Material("wall", grey(0.5), grey(0.5 / math.pi))],
    )
    model.group("cube")
    box(model, "wall", (0, 0, 0), (1, 1, 1), inward=True)
    return model


def parallel_squares():
    model = Model(
        "parallel_squares",
        ["Two squares of 1 m facing each other at 1 m, z up; the lower one emits 1 W/m^2.", "Form factor 0.199824896."],
        two_square_materials(),
    )
    model.group("source")
    model.face("source", (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    model.group("receiver")
    model.face("receiver", (0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1))
    return model


def perpendicular_squares():
    model = Model(
        "perpendicular_squares",
        [
            "Two squares of 1 m that share an edge at a right angle, z up; the lower one emits 1 W/m^2.",
            "Form factor 0.200043776.",
        ],
        two_square_materials(),
    )
    model.group("source")
    model.face("source", (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    model.group("receiver")
    model.face("receiver", (0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1))
    return model


def two_square_materials():
    return [Material("source", grey(0), grey(1 / math.pi)), Material("receiver", grey(0))]


# The two rooms: A is 4.0 x 3.0 m, B is 3.0 x 3.0 m, both 2.7 m high; the wall between them is 10 cm thick.
ROOM_HEIGHT, ROOM_DEPTH = 2.7, 3.0
WALL_A, WALL_B, FAR_END = 4.0, 4.1, 7.1
DOOR_NEAR, DOOR_FAR, DOOR_HEIGHT = 1.0, 1.9, 2.05


def two_rooms():
    model = Model(
        "two_rooms",
        [
            "Two furnished rooms joined by a door opening, z up, metres. The outer shell is one closed box with normals",
            "inward: its floor, ceiling and long walls run on under, over and behind the dividing wall. Table tops,",
            "seats, shelves and lamps are closed solids. Faces that touch another surface all over (the ends of legs",
            "and of the dividing wall) are left out.",
        ],
        [
            Material("floor_oak", (0.48, 0.34, 0.21)),
            Material("plaster_white", grey(0.78)),
            Material("wall_red", (0.62, 0.12, 0.09)),
            Material("wall_blue", (0.12, 0.22, 0.58)),
            Material("wall_green", (0.2, 0.5, 0.16)),
            Material("wall_yellow", (0.75, 0.62, 0.2)),
            Material("beech", (0.6, 0.45, 0.28)),
            Material("steel", grey(0.35)),
            Material("fabric_teal", (0.08, 0.35, 0.36)),
            Material("lamp_body", grey(0.7)),
            Material("lamp_warm", grey(0.7), (26, 19, 11)),
            Material("lamp_cool", grey(0.7), (7, 9, 12)),
        ],
    )
    shell(model)
    dividing_wall(model)
    furnish_room_a(model)
    furnish_room_b(model)
    return model


def shell(model):
    model.group("shell")
    ends = {"-x": "wall_red", "+x": "wall_green", "-z": "floor_oak"}
    box(model, "plaster_white", (0, 0, 0), (FAR_END, ROOM_DEPTH, ROOM_HEIGHT), inward=True, materials=ends)


def dividing_wall(model):
    model.group("dividing_wall")
    outline = [  # (y, z), counter-clockwise seen from room B
        (0, 0), (DOOR_NEAR, 0), (DOOR_NEAR, DOOR_HEIGHT), (DOOR_FAR, DOOR_HEIGHT),
        (DOOR_FAR, 0), (ROOM_DEPTH, 0), (ROOM_DEPTH, ROOM_HEIGHT), (0, ROOM_HEIGHT),
    ]
    model.face("wall_blue", *[(WALL_B, y, z) for y, z in outline])
    model.face("wall_yellow", *[(WALL_A, y, z) for y, z in reversed(outline)])
    for (y0, z0), (y1, z1) in zip(outline[1:4], outline[2:5]):
        model.face("plaster_white", (WALL_A, y0, z0), (WALL_A, y1, z1), (WALL_B, y1, z1), (WALL_B, y0, z0))


def furnish_room_a(model):
    table(model, "table_dining", (1.2, 0.9), (2.8, 1.8), 0.74, leg=0.05)
    chair(model, "chair_1", (1.65, 0.6), "+y")
    chair(model, "chair_2", (2.35, 0.6), "+y")
    chair(model, "chair_3", (1.65, 2.1), "-y")
    chair(model, "chair_4", (2.35, 2.1), "-y")
    table(model, "table_side", (3.35, 2.45), (3.85, 2.95), 0.45, leg=0.03)
    shelf(model, "shelf_a", 0.3, 1.7, ROOM_DEPTH - 0.01, heights=[0.08, 0.48, 0.88, 1.28, 1.68])
    lamp(model, "lamp_a", "lamp_warm", (2.0, 1.4), (1.2, 0.3))


def furnish_room_b(model):
    table(model, "table_desk", (5.3, 2.2), (6.9, 2.9), 0.72, leg=0.04)
    chair(model, "chair_5", (6.1, 1.95), "+y")
    table(model, "table_low", (5.2, 0.7), (6.0, 1.3), 0.4, leg=0.03)
    chair(model, "chair_6", (6.6, 1.0), "-x")
    shelf(model, "shelf_b", 4.3, 5.1, ROOM_DEPTH - 0.01, heights=[0.08, 0.5, 0.92, 1.34])
    lamp(model, "lamp_b", "lamp_cool", (5.6, 1.5), (0.6, 0.6))


def table(model, name, low, high, height, leg):
    """A top 3 cm thick on four square legs that stand 5 cm in from its edges."""
    model.group(name)
    box(model, "beech", (*low, height - 0.03), (*high, height))
    for x in (low[0] + 0.05, high[0] - 0.05 - leg):
        for y in (low[1] + 0.05, high[1] - 0.05 - leg):
            box(model, "steel", (x, y, 0), (x + leg, y + leg, height - 0.03), sides="+x-x+y-y")


def chair(model, name, centre, faces):
    """A seat 42 x 42 cm, four legs of 3 cm and a back; `faces` is where a sitter looks."""
    model.group(name)
    half, seat, thick, leg = 0.21, 0.45, 0.03, 0.03
    x, y = centre
    box(model, "fabric_teal", (x - half, y - half, seat - thick), (x + half, y + half, seat))
    for lx in (x - half + 0.01, x + half - 0.01 - leg):
        for ly in (y - half + 0.01, y + half - 0.01 - leg):
            box(model, "steel", (lx, ly, 0), (lx + leg, ly + leg, seat - thick), sides="+x-x+y-y")
    # The back floats 12 cm above the seat, on two posts 1 cm behind the seat.
    post, gap, inset = 0.03, 0.01, 0.02
    if faces in ("+y", "-y"):
        rear = y - half - gap - post if faces == "+y" else y + half + gap
        posts = [(x - half + inset, rear), (x + half - inset - post, rear)]
        low, high = (x - half, rear, seat + 0.12), (x + half, rear + post, 0.9)
    else:
        rear = x - half - gap - post if faces == "+x" else x + half + gap
        posts = [(rear, y - half + inset), (rear, y + half - inset - post)]
        low, high = (rear, y - half, seat + 0.12), (rear + post, y + half, 0.9)
    box(model, "beech", low, high)
    for px, py in posts:
        box(model, "beech", (px, py, 0), (px + post, py + post, seat + 0.12), sides="+x-x+y-y")


def shelf(model, name, x0, x1, back, heights):
    """A board before the wall y = `back` with shelves of 2.5 cm: one comb-shaped profile, extruded along x."""
    model.group(name)
    board, depth, panel = 0.025, 0.28, 0.02
    profile = [(0, heights[0])]  # (distance from the wall, height)
    for k, z in enumerate(heights):
        profile += [(depth, z), (depth, z + board)]
        if k + 1 < len(heights):
            profile += [(panel, z + board), (panel, heights[k + 1])]
    profile.append((0, heights[-1] + board))
    # u = towards the room (-y), v = up, so w = u x v points along -x.
    prism(model, "beech", profile, lambda u, v, w: (x1 + w * (x0 - x1), back - u, v))


def lamp(model, name, material, centre, size):
    """A flat body that hangs 12 cm under the ceiling and shines downward."""
    model.group(name)
    (x, y), (sx, sy), top = centre, size, ROOM_HEIGHT - 0.12
    low, high = (x - sx / 2, y - sy / 2, top - 0.05), (x + sx / 2, y + sy / 2, top)
    box(model, "lamp_body", low, high, materials={"-z": material})


def bathroom():
    model = Model(
        "bathroom",
        [
            "A bathroom of 2.4 x 2 x 2.5 m, z up, metres: basin on a cabinet, tub, a mirror 1 cm before the wall in a",
            "frame, a lamp over it, a towel. Mirror, lamp and a view are in bathroom.toml.",
        ],
        [
            Material("tiles", (0.75, 0.77, 0.78)),
            Material("floor_tiles", (0.35, 0.36, 0.38)),
            Material("ceiling", grey(0.85)),
            Material("green_wall", (0.35, 0.55, 0.45)),
            Material("cabinet", (0.45, 0.3, 0.2)),
            Material("porcelain", (0.85, 0.85, 0.84)),
            Material("mirror", grey(0)),
            Material("frame", grey(0.5)),
            Material("lamp", grey(0)),
            Material("towel", (0.7, 0.2, 0.15)),
        ],
    )
    model.group("room")
    walls = {"-z": "floor_tiles", "+z": "ceiling", "+x": "green_wall"}
    box(model, "tiles", (0, 0, 0), (2.4, 2, 2.5), inward=True, materials=walls)
    for name, material, low, high in [
        ("cabinet", "cabinet", (0.1, 0, 0), (0.9, 0.5, 0.82)),
        ("basin", "porcelain", (0.05, 0, 0.82), (0.95, 0.55, 0.86)),
        ("tub", "porcelain", (1.5, 0, 0), (2.4, 2, 0.55)),
        ("towel", "towel", (0, 0.9, 0.9), (0.03, 1.4, 1.6)),
    ]:
        model.group(name)
        box(model, material, low, high)
    model.group("mirror")
    (x0, x1), (z0, z1), rim = (0.1, 0.9), (1.05, 1.95), 0.03
    model.face("mirror", (x0, 0.01, z0), (x0, 0.01, z1), (x1, 0.01, z1), (x1, 0.01, z0))
    for low, high in [
        ((x0 - rim, z0 - rim), (x1 + rim, z0)),
        ((x0 - rim, z1), (x1 + rim, z1 + rim)),
        ((x0 - rim, z0), (x0, z1)),
        ((x1, z0), (x1 + rim, z1)),
    ]:
        box(model, "frame", (low[0], 0, low[1]), (high[0], 0.02, high[1]), sides="+x-x+y+z-z")
    model.group("lamp")
    box(model, "frame", (0.2, 0, 2.05), (0.8, 0.12, 2.13), sides="+x-x+y+z-z", materials={"+y": "lamp"})
    return model


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; fail when a file differs")
    check = parser.parse_args().check
    differing = []
    for make in (cornell_box, furnace_cube, parallel_squares, perpendicular_squares, two_rooms, bathroom):
        model = make()
        for suffix, text in (("obj", model.obj()), ("mtl", model.mtl())):
            path = MESHES / f"{model.name}.{suffix}"
            if check:
                if not path.exists() or path.read_text() != text:
                    differing.append(path.name)
            else:
                MESHES.mkdir(exist_ok=True)
                path.write_text(text)
    if differing:
        sys.exit("these files are not what scripts/make_meshes.py writes: " + ", ".join(differing))


if __name__ == "__main__":
    main()
