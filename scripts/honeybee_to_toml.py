#!/usr/bin/env python3
"""Turns a honeybee model (HBJSON) into a scene file for daylight: SCENE.toml, SCENE.obj and SCENE.mtl.

usage: scripts/honeybee_to_toml.py MODEL.hbjson SCENE.toml [--illuminance LX]

Rooms, apertures, doors and shades become faces, sensor grids and views come along, the sky is a CIE overcast one with
the horizontal illuminance asked for (10,000 lx) over a ground with reflectance 0.2. Modifiers of the model are not read:
reflectances are those of honeybee's generic modifiers, by the kind of face. Interior apertures are seen once, from the
room that comes first.
"""
import argparse
import json
import math
import pathlib
import sys

# Reflectance and transmittance. The opaque ones, and the 0.64 of a window, are honeybee's generic modifiers; two
# surfaces of glass with the index 1.52 reflect 0.043 each.
MATERIALS = {
    "floor": (0.2, 0), "wall": (0.5, 0), "ceiling": (0.8, 0), "door": (0.5, 0), "window": (0.08, 0.64),
    "interior_window": (0.08, 0.88), "exterior_shade": (0.35, 0), "interior_shade": (0.5, 0), "context": (0.2, 0),
}
FACES = {"Floor": "floor", "Wall": "wall", "RoofCeiling": "ceiling"}  # an AirBoundary is a hole
UNITS = {"Meters": "m", "Centimeters": "cm", "Millimeters": "mm", "Inches": "in", "Feet": "ft"}
GROUND = 0.2


def add(a, b, factor=1):
    return [x + factor * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def area_vector(polygon):
    """Newell's vector area: normal to the side from which the corners run anticlockwise."""
    total = [0, 0, 0]
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        total = add(total, cross(a, b), 0.5)
    return total


def crosses(a, b, c, d, normal):
    """Do segments a-b and c-d of one plane cross, ends left out?"""
    def side(p, q, r):
        return dot(cross(add(q, p, -1), add(r, p, -1)), normal)
    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def with_hole(outline, hole, others):
    """The outline joined to a hole by the shortest seam that crosses no edge."""
    normal = area_vector(outline)
    if dot(area_vector(hole), normal) > 0:
        hole = hole[::-1]
    edges = [(p, q) for ring in [outline, hole, *others] for p, q in zip(ring, ring[1:] + ring[:1])]
    seams = sorted((math.dist(a, b), i, j) for i, a in enumerate(outline) for j, b in enumerate(hole))
    for _, i, j in seams:
        if not any(crosses(outline[i], hole[j], p, q, normal) for p, q in edges):
            return outline[:i + 1] + hole[j:] + hole[:j + 1] + outline[i:]
    sys.exit("error: a hole lies outside its face")


class Model:
    """Faces for an OBJ file, in groups."""

    def __init__(self):
        self.vertices, self.lines = [], []

    def add_face(self, group, material, outline, holes=()):
        holes = list(holes)
        while holes:
            outline = with_hole(outline, holes.pop(0), holes)
        numbers = []
        for point in outline:
            self.vertices.append(point)
            numbers.append(len(self.vertices))
        self.lines += [f"o {group}", f"usemtl {material}", "f " + " ".join(map(str, numbers))]

    def write(self, file, materials):
        lines = [f"mtllib {materials}"] + ["v " + " ".join(repr(float(x)) for x in v) for v in self.vertices]
        file.write_text("\n".join(lines + self.lines) + "\n")


def add_geometry(model, group, material, item, holes=()):
    geometry = item["geometry"]
    model.add_face(group, material, geometry["boundary"], [*(geometry.get("holes") or []), *holes])


def add_shades(model, owner):
    for key, material in (("outdoor_shades", "exterior_shade"), ("indoor_shades", "interior_shade")):
        for shade in owner.get(key) or []:
            add_geometry(model, shade["identifier"], material, shade)


def partner_of(item):
    """The identifier of what lies back to back with it, if anything."""
    condition = item["boundary_condition"]
    return condition["boundary_condition_objects"][0] if condition["type"] == "Surface" else None


def add_openings(model, face, done):
    for opening in (face.get("apertures") or []) + (face.get("doors") or []):
        inside = opening["boundary_condition"]["type"] == "Surface"
        clear = opening["type"] == "Aperture" or opening.get("is_glass")
        add_shades(model, opening)
        if inside and partner_of(opening) in done:
            continue
        done.add(opening["identifier"])
        window = "interior_window" if inside else "window"
        add_geometry(model, opening["identifier"], window if clear else "door", opening)


def model_of(building):
    model, done = Model(), set()
    for room in building.get("rooms") or []:
        add_shades(model, room)
        for face in room["faces"]:
            add_shades(model, face)
            openings = (face.get("apertures") or []) + (face.get("doors") or [])
            if face["face_type"] in FACES:
                holes = [opening["geometry"]["boundary"] for opening in openings]
                add_geometry(model, face["identifier"], FACES[face["face_type"]], face, holes)
            add_openings(model, face, done)
    for shade in building.get("orphaned_shades") or []:
        add_geometry(model, shade["identifier"], "context", shade)
    return model


def lattice(sensors):
    """Corner, edges and spacing of a level square lattice that looks up; nothing for other sensors."""
    xs, ys, zs = (sorted({round(s["pos"][k], 6) for s in sensors}) for k in range(3))
    steps = [round(b - a, 5) for values in (xs, ys) for a, b in zip(values, values[1:])]
    looks_up = all(s["dir"] == [0, 0, 1] for s in sensors)
    if len(set(steps)) != 1 or len(zs) != 1 or len(xs) * len(ys) != len(sensors) or not looks_up:
        return None
    step = steps[0]
    return [xs[0] - step / 2, ys[0] - step / 2, zs[0]], [[step * len(xs), 0, 0], [0, step * len(ys), 0]], step


def text(value):
    return json.dumps(value)


def sensors_of(grid):
    lines = ["[[sensors]]", f"name = {text(grid['identifier'])}"]
    found = lattice(grid["sensors"])
    if found:
        corner, edges, spacing = found
        return lines + [f"corner = {text(corner)}", f"edges = {text(edges)}", f"spacing = {spacing}"]
    points = [text([float(x) for x in s["pos"] + s["dir"]]) for s in grid["sensors"]]
    return lines + ["points = [\n  " + ",\n  ".join(points) + "]"]


def camera_of(view):
    target = add(view["position"], view["direction"])
    return ["[[camera]]", f"name = {text(view['identifier'])}", f"eye = {text(view['position'])}",
            f"target = {text(target)}", f"field_of_view = {view.get('v_size', 60)}"]


def scene_of(building, obj, illuminance):
    unit = UNITS[building.get("units", "Meters")]
    parts = [[f"unit = {text(unit)}", 'up = "z"'], ["[[model]]", f"file = {text(obj)}", f"unit = {text(unit)}"]]
    parts += [["[[material]]", f"name = {text(name)}", f"transmittance = {tau}"]
              for name, (_, tau) in used(MATERIALS, building).items() if tau > 0]
    parts += [["[sky]", 'kind = "overcast"', f"illuminance = {illuminance}"], ["[ground]", f"reflectance = {GROUND}"]]
    light = building["properties"].get("radiance") or {}
    parts += [sensors_of(grid) for grid in light.get("sensor_grids") or []]
    parts += [camera_of(view) for view in light.get("views") or []]
    return "\n\n".join("\n".join(part) for part in parts) + "\n"


def used(materials, building):
    lines = model_of(building).lines
    return {name: values for name, values in materials.items() if f"usemtl {name}" in lines}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--illuminance", type=float, default=10000)
    arguments = parser.parse_args()
    building = json.loads(arguments.model.read_text())
    obj, mtl = arguments.scene.with_suffix(".obj"), arguments.scene.with_suffix(".mtl")
    model_of(building).write(obj, mtl.name)
    mtl.write_text("".join(f"newmtl {name}\nKd {rho} {rho} {rho}\n" for name, (rho, _) in MATERIALS.items()))
    arguments.scene.write_text(scene_of(building, obj.name, arguments.illuminance))


if __name__ == "__main__":
    main()
