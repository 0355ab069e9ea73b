#!/usr/bin/env python3
"""Writes rooms for large numbers of patches: 10 x 8 x 3 m, closed, with four lamps of 0.6 x 0.6 m below the ceiling.

usage: scripts/make_large_rooms.py FOLDER [SUBDIVISION]
boxes.obj: 500 boxes of all sizes, turned, on the floor (1 mm above it) or hanging; spheres.obj: 300 spheres in place of
these, of SUBDIVISION x twice as many triangles each (default 28: 924,000 in all); uplight.obj: boxes.obj with the lamps
0.5 m below the ceiling, shining at it.
"""
import math
import pathlib
import sys

from make_meshes import Material, Model, grey

LENGTH, WIDTH, HEIGHT = 10, 8, 3
EXITANCE = 20


class Random:
    """The 64-bit xorshift* generator of Marsaglia and Vigna."""

    MASK = (1 << 64) - 1

    def __init__(self, seed):
        self.state = (seed * 0x9E3779B97F4A7C15 + 0x1234567) & self.MASK
        self.next()
        self.next()

    def next(self):
        self.state ^= (self.state << 13) & self.MASK
        self.state ^= self.state >> 7
        self.state ^= (self.state << 17) & self.MASK
        return self.state * 0x2545F4914F6CDD1D & self.MASK

    def uniform(self):
        return ((self.next() >> 11) + 0.5) / 9007199254740992


def turned_box(model, material, center, half, angle, inward=False, materials=None):
    """Faces by axis and end, as (2, 0) for the bottom; `materials` overrides some."""
    c, s = math.cos(angle), math.sin(angle)
    axes = ((c, s, 0), (-s, c, 0), (0, 0, 1))
    for axis in range(3):
        for end in (0, 1):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            if (end == 1) == inward:
                u, v = v, u

            def corner(a, b):
                steps = {axis: 2 * end - 1, u: a, v: b}
                return tuple(center[d] + sum(steps[k] * half[k] * axes[k][d] for k in range(3)) for d in range(3))

            model.face((materials or {}).get((axis, end), material), corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1))


def sphere(model, material, center, radius, rings):
    def point(i, j):
        theta, phi = math.pi * i / rings, math.pi * (j % (2 * rings)) / rings
        return (
            center[0] + radius * math.sin(theta) * math.cos(phi),
            center[1] + radius * math.sin(theta) * math.sin(phi),
            center[2] + radius * math.cos(theta),
        )

    for i in range(rings):
        for j in range(2 * rings):
            p, q, t, w = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            if i < rings - 1:
                model.face(material, p, q, t)
            if i > 0:
                model.face(material, p, t, w)


def things(random, count, lamp_height, are_spheres):
    """Places that keep clear of each other and of the lamps: (center, half edges, angle, reflectance)."""
    taken = [((x, y, lamp_height), 0.45, 0.05) for x in (2.5, 7.5) for y in (2, 6)]
    found = []
    while len(found) < count:
        size = 0.06 + 0.3 * random.uniform() * random.uniform()
        half = tuple(size * (0.4 + f * random.uniform()) for f in (0.6, 0.6, 1.2))
        radius = math.hypot(half[0], half[1])
        on_floor = random.uniform() < 0.5
        if are_spheres:
            half, radius = (size, size, size), size
        x = radius + 0.02 + random.uniform() * (LENGTH - 2 * radius - 0.04)
        y = radius + 0.02 + random.uniform() * (WIDTH - 2 * radius - 0.04)
        z = half[2] + 0.001 if on_floor else half[2] + 0.05 + random.uniform() * (HEIGHT - 2 * half[2] - 0.5)
        angle = 3 * random.uniform()
        near = lambda q: math.hypot(q[0][0] - x, q[0][1] - y) < q[1] + radius and abs(q[0][2] - z) < q[2] + half[2] + 0.002
        if any(near(q) for q in taken):
            continue
        taken.append(((x, y, z), radius, half[2]))
        found.append(((x, y, z), half, angle, 0.2 + 0.6 * random.uniform()))
    return found


def room(name, count, are_spheres=False, shines_up=False, rings=0):
    lamp_height = HEIGHT - 0.5 if shines_up else HEIGHT - 0.06
    placed = things(Random(5), count, lamp_height, are_spheres)
    materials = [Material("wall", grey(0.7)), Material("floor", grey(0.35)), Material("ceiling", grey(0.8)),
                 Material("light", grey(0.5), grey(EXITANCE / math.pi)), Material("housing", grey(0.5))]
    materials += [Material(f"thing{k}", grey(round(p[3], 4))) for k, p in enumerate(placed)]
    model = Model(name, ["A closed room of 10 x 8 x 3 m with four lamps and many things."], materials)
    model.group("room")
    turned_box(model, "wall", (LENGTH / 2, WIDTH / 2, HEIGHT / 2), (LENGTH / 2, WIDTH / 2, HEIGHT / 2), 0, True,
               {(2, 0): "floor", (2, 1): "ceiling"})
    model.group("lamps")
    for x in (2.5, 7.5):
        for y in (2, 6):
            turned_box(model, "housing", (x, y, lamp_height), (0.3, 0.3, 0.02), 0, False, {(2, int(shines_up)): "light"})
    model.group("things")
    for k, (center, half, angle, _) in enumerate(placed):
        if are_spheres:
            sphere(model, f"thing{k}", center, half[0], rings)
        else:
            turned_box(model, f"thing{k}", center, half, angle)
    return model


def main():
    if len(sys.argv) not in (2, 3):
        raise SystemExit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    rings = int(sys.argv[2]) if len(sys.argv) > 2 else 28
    for model in (room("boxes", 500), room("uplight", 500, shines_up=True), room("spheres", 300, True, rings=rings)):
        (folder / f"{model.name}.obj").write_text(model.obj())
        (folder / f"{model.name}.mtl").write_text(model.mtl())


if __name__ == "__main__":
    main()
