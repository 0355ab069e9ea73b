#!/usr/bin/env python3
"""Writes the rooms that the benchmarks of form factors run in, watertight OBJ models with normals into the room.

usage: scripts/make_rooms.py FOLDER
closed_room_N.obj: a unit cube with two blocks whose faces are grids of N squares per meter, cut into triangles;
boxes_500.obj: a room of 8 x 8 x 3 m with 80 boxes on its floor and 420 that hang free, at random places.
"""

import collections
import pathlib
import random
import sys

from make_meshes import Material, Model, box, grey

BLOCKS = [((0.1, 0.2), (0.4, 0.5), 0.3), ((0.5, 0.5), (0.8, 0.8), 0.6)]


def halved_grid(model, place, counts, is_left_out=lambda u, v: False):
    """Squares cut into triangles; place(u, v) is a grid point, right-handed with the normal."""
    for u in range(counts[0]):
        for v in range(counts[1]):
            if is_left_out(u, v):
                continue
            a, b, c, d = place(u, v), place(u + 1, v), place(u + 1, v + 1), place(u, v + 1)
            model.face("wall", a, b, c)
            model.face("wall", a, c, d)


def grid_box(model, low, high, n, inward, is_left_out):
    """The six sides of a box with corners in units of 1/n; `is_left_out` is asked for cells of the side below."""
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (low, high):
            # A side's normal points along its axis at the high end of a solid and at the low end of a room.
            turned = (end is low) != inward
            first, second = (v, u) if turned else (u, v)

            def place(s, t):
                point = [0, 0, 0]
                point[axis] = end[axis]
                point[first], point[second] = low[first] + s, low[second] + t
                return tuple(x / n for x in point)

            below = axis == 2 and end is low
            halved_grid(
                model,
                place,
                (high[first] - low[first], high[second] - low[second]),
                (lambda s, t: is_left_out(low[first] + s, low[second] + t)) if below else lambda s, t: False,
            )


def closed_room(n):
    comment = [f"A closed unit cube with two blocks on its floor; faces are grids of spacing 1/{n} cut into triangles."]
    model = Model(f"closed_room_{n}", comment, [Material("wall", grey(0.5))])
    in_cells = [[tuple(round(x * n) for x in corner) for corner in (a, b)] + [round(h * n)] for a, b, h in BLOCKS]
    covered = {(x, y) for a, b, _ in in_cells for x in range(a[0], b[0]) for y in range(a[1], b[1])}
    model.group("room")
    # Seen from inside, the floor's first direction is x: covered cells are given as (x, y).
    grid_box(model, (0, 0, 0), (n, n, n), n, True, lambda x, y: (x, y) in covered)
    for k, (a, b, height) in enumerate(in_cells):
        model.group(f"block_{k + 1}")
        grid_box(model, (*a, 0), (*b, height), n, False, lambda x, y: True)
    return model


CELL, CELLS, HEIGHT = 0.25, 32, 3.0
STANDING, HANGING, GAP = 80, 420, 0.02


def boxes_room():
    """Every edge has the same corners on both of its sides: walls and standing boxes follow the floor's grid."""
    comment = ["A closed room of 8 x 8 x 3 m; 80 boxes stand on the floor, which is cut out under them, 420 hang free."]
    model = Model("boxes_500", comment, [Material("wall", grey(0.5)), Material("box", grey(0.5))])
    rng = random.Random(1)
    standing = standing_boxes(rng)
    covered = {(x, y) for (x0, y0), (x1, y1), _ in standing for x in range(x0, x1) for y in range(y0, y1)}
    model.group("room")
    size = CELL * CELLS
    for x in range(CELLS):
        for y in range(CELLS):
            if (x, y) not in covered:
                corners = ((x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1))
                model.face("wall", *[(CELL * u, CELL * v, 0) for u, v in corners])
    model.face("wall", (0, 0, HEIGHT), (0, size, HEIGHT), (size, size, HEIGHT), (size, 0, HEIGHT))
    grid_walls(model, "wall", ((0, 0), (CELLS, CELLS)), HEIGHT, inward=True)
    model.group("standing")
    for low, high, height in standing:
        grid_walls(model, "box", (low, high), height, inward=False)
        (x0, y0), (x1, y1) = [tuple(CELL * c for c in corner) for corner in (low, high)]
        model.face("box", (x0, y0, height), (x1, y0, height), (x1, y1, height), (x0, y1, height))
    model.group("hanging")
    for low, high in hanging_boxes(rng, standing):
        box(model, "box", low, high)
    return model


def grid_walls(model, material, footprint, height, inward):
    """Four walls on a rectangle of grid points, with a corner at each grid point of their feet."""
    (x0, y0), (x1, y1) = footprint
    feet = [
        [(x, y0) for x in range(x0, x1 + 1)],
        [(x1, y) for y in range(y0, y1 + 1)],
        [(x, y1) for x in range(x1, x0 - 1, -1)],
        [(x0, y) for y in range(y1, y0 - 1, -1)],
    ]
    for foot in feet:
        bottom = [(CELL * x, CELL * y, 0) for x, y in foot]
        corners = bottom + [(*bottom[-1][:2], height), (*bottom[0][:2], height)]
        model.face(material, *(corners[::-1] if inward else corners))


def standing_boxes(rng):
    """Boxes of 1 or 2 cells a side that keep a cell away from each other and from the walls."""
    boxes, taken = [], set()
    while len(boxes) < STANDING:
        x, y, w, d = rng.randint(1, CELLS - 3), rng.randint(1, CELLS - 3), rng.randint(1, 2), rng.randint(1, 2)
        around = {(u, v) for u in range(x - 1, x + w + 1) for v in range(y - 1, y + d + 1)}
        inside = {(u, v) for u in range(x, x + w) for v in range(y, y + d)}
        if not inside & taken:
            boxes.append(((x, y), (x + w, y + d), round(rng.uniform(0.2, 1.2), 3)))
            taken |= around
    return boxes


def hanging_boxes(rng, standing):
    solids = [((CELL * a[0], CELL * a[1], 0), (CELL * b[0], CELL * b[1], h)) for a, b, h in standing]
    boxes = []
    while len(boxes) < HANGING:
        edges = [rng.uniform(0.15, 0.6) for _ in range(3)]
        room = (CELL * CELLS, CELL * CELLS, HEIGHT)
        low = [round(rng.uniform(GAP, room[d] - GAP - edges[d]), 3) for d in range(3)]
        high = [round(low[d] + edges[d], 3) for d in range(3)]
        if all(any(high[d] + GAP < l[d] or h[d] + GAP < low[d] for d in range(3)) for l, h in solids):
            solids.append((low, high))
            boxes.append((low, high))
    return boxes


def check_watertight(model):
    """Every edge is walked once each way."""
    edges = collections.Counter()
    for line in model.lines:
        if line.startswith("f "):
            corners = line.split()[1:]
            edges.update(zip(corners, corners[1:] + corners[:1]))
    open_edges = [e for e, n in edges.items() if n != 1 or edges[e[::-1]] != 1]
    assert not open_edges, f"{model.name} has {len(open_edges)} open edges"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for model in [closed_room(n) for n in (10, 20, 40)] + [boxes_room()]:
        check_watertight(model)
        (folder / f"{model.name}.obj").write_text(model.obj())
        (folder / f"{model.name}.mtl").write_text(model.mtl())
        print(f"{model.name}: {model.faces} polygons, watertight")


if __name__ == "__main__":
    main()
