#!/usr/bin/env python3
"""Turns a Mitsuba scene (0.5 to 3, XML) into one OBJ file and one MTL file beside it, in metres.

usage: scripts/mitsuba_to_obj.py SCENE.xml OUT.obj

Shapes obj, rectangle, cube, disk and sphere (the last two as facets) come with their toWorld transformations. A BSDF
becomes its diffuse reflectance, an area emitter the Ke of its shape. What cannot be carried over is named on stderr.
"""
import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

IDENTITY = [[float(i == j) for j in range(4)] for i in range(4)]
WRAPPERS = ("twosided", "bumpmap", "normalmap", "mask", "opacity")  # what they change is not diffuse light
COLOR_NAMES = ("reflectance", "diffuseReflectance", "diffuse_reflectance", "base_color", "baseColor",
               "specularReflectance", "specular_reflectance")
GREY = (0.5, 0.5, 0.5)  # where nothing is known
FACETS = 24  # of a disk's or sphere's circumference


def multiply(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def numbers(text):
    return [float(word) for word in text.replace(",", " ").split()]


def vector(element, default):
    """x, y, z of an element, given as value="x, y, z" or one by one."""
    if "value" in element.attrib:
        values = numbers(element.get("value"))
        return values * 3 if len(values) == 1 else values
    return [float(element.get(axis, default)) for axis in "xyz"]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    if length == 0:
        raise ValueError("a direction of length 0")
    return [x / length for x in a]


def rotation(axis, degrees):
    """Rodrigues' formula."""
    x, y, z = unit(axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    t = 1 - c
    return [[t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0], [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0], [0, 0, 0, 1]]


def look_at(origin, target, up):
    """From a frame that looks along +z, with y up, to the world; the x axis points to the left."""
    forward = unit(minus(target, origin))
    left = unit(cross(up, forward))
    new_up = cross(forward, left)
    return [[left[i], new_up[i], forward[i], origin[i]] for i in range(3)] + [[0, 0, 0, 1]]


def step_matrix(step):
    """The matrix of one step of a <transform>."""
    if step.tag == "matrix":
        values = numbers(step.get("value"))
        if len(values) == 9:
            return [values[0:3] + [0], values[3:6] + [0], values[6:9] + [0], [0, 0, 0, 1]]
        return [values[4 * i:4 * i + 4] for i in range(4)]
    if step.tag == "translate":
        return [row[:3] + [shift] for row, shift in zip(IDENTITY, vector(step, 0) + [1])]
    if step.tag == "scale":
        return [[factor * value for value in row] for row, factor in zip(IDENTITY, vector(step, 1) + [1])]
    if step.tag == "rotate":
        return rotation(vector(step, 0), float(step.get("angle")))
    if step.tag.lower() == "lookat":
        up = numbers(step.get("up", "0, 1, 0"))
        return look_at(numbers(step.get("origin")), numbers(step.get("target")), up)
    raise ValueError(f"the transformation <{step.tag}> is not known")


def to_world(shape):
    matrix = IDENTITY
    for transform in shape.findall("transform"):
        if transform.get("name") in ("toWorld", "to_world"):
            for step in transform:
                matrix = multiply(step_matrix(step), matrix)
    return matrix


def determinant(m):
    return sum(m[0][i] * cross(m[1][:3], m[2][:3])[i] for i in range(3))


class Scene:
    """What is read, and what could not be."""

    def __init__(self, file):
        self.file = file
        self.bsdfs = {}  # by id
        self.materials = {}  # name: (reflectance, radiance)
        self.vertices = []
        self.lines = []  # of the OBJ file, after the vertices
        self.faces = 0
        self.complaints = []

    def complain(self, text):
        if text not in self.complaints:
            self.complaints.append(text)

    def spectrum(self, element, what):
        """A colour as linear RGB, or None."""
        if element.tag == "texture":
            return self.texture(element, what)
        if element.tag not in ("rgb", "srgb", "spectrum", "float"):
            return None
        text = element.get("value", "")
        if text.startswith("#"):
            return tuple(srgb_to_linear(int(text[k:k + 2], 16) / 255) for k in (1, 3, 5))
        if ":" in text:  # wavelength:value pairs
            self.complain(f"{what}: the spectrum is replaced by its mean")
            values = [float(pair.split(":")[1]) for pair in text.replace(",", " ").split()]
            return (sum(values) / len(values),) * 3
        values = numbers(text)
        if element.tag == "srgb":
            values = [srgb_to_linear(value) for value in values]
        return tuple(values) if len(values) == 3 else tuple(values[:1] * 3)

    def texture(self, element, what):
        if element.get("type") == "checkerboard":
            colors = [self.spectrum(part, what) for part in element if part.get("name") in ("color0", "color1")]
            if len(colors) == 2:
                self.complain(f"{what}: the checkerboard is replaced by its mean")
                return tuple((a + b) / 2 for a, b in zip(*colors))
        name = next((part.get("value") for part in element if part.get("name") == "filename"), element.get("type"))
        self.complain(f"{what}: the texture {name} is replaced by 0.5")
        return GREY

    def reflectance(self, bsdf, what):
        """The diffuse reflectance that stands for a BSDF."""
        kind = bsdf.get("type")
        inner = bsdf.find("bsdf")
        reference = bsdf.find("ref")
        if kind in WRAPPERS:
            if kind != "twosided":
                self.complain(f"{what}: {kind} is left out")
            if inner is None and reference is not None:
                inner = self.bsdfs.get(reference.get("id"))
            return self.reflectance(inner, what) if inner is not None else GREY
        color = next((self.spectrum(part, what) for name in COLOR_NAMES for part in bsdf if part.get("name") == name), None)
        if kind in ("diffuse", "roughdiffuse", "lambertian"):
            return color or GREY
        if kind in ("dielectric", "thindielectric", "roughdielectric"):
            self.complain(f"{what}: {kind} (glass) becomes matt black: what it lets through is lost")
            return (0.0, 0.0, 0.0)
        if kind == "null":
            self.complain(f"{what}: null (nothing) becomes matt black")
            return (0.0, 0.0, 0.0)
        self.complain(f"{what}: {kind} becomes matt")
        return color or GREY

    def material(self, shape, name):
        """The name of the shape's material, which is added when it is new."""
        bsdf = shape.find("bsdf")
        for reference in shape.findall("ref"):
            bsdf = self.bsdfs.get(reference.get("id"), bsdf)
        key = (bsdf.get("id") if bsdf is not None else None) or name
        rho = self.reflectance(bsdf, key) if bsdf is not None else GREY
        if bsdf is None:
            self.complain(f"{key}: no BSDF; reflectance 0.5")
        radiance = (0.0, 0.0, 0.0)
        emitter = shape.find("emitter")
        if emitter is not None and emitter.get("type") == "area":
            radiance = next((self.spectrum(part, key) for part in emitter if part.get("name") == "radiance"), (1.0, 1.0, 1.0))
        elif emitter is not None:
            self.complain(f"{key}: the emitter {emitter.get('type')} is left out")
        rho = tuple(min(1.0, max(0.0, value)) for value in rho)
        base, copy = "_".join(key.split()), 1
        key = base
        while self.materials.get(key, (rho, radiance)) != (rho, radiance):
            copy += 1
            key = f"{base}_{copy}"
        self.materials[key] = (rho, radiance)
        return key

    def add_shape(self, shape, number):
        kind = shape.get("type")
        name = shape.get("id") or kind
        if kind == "obj":
            mesh = self.read_mesh(shape)
            name = shape.get("id") or next(
                pathlib.PurePath(part.get("value")).stem for part in shape if part.get("name") == "filename")
        elif kind in PRIMITIVES:
            mesh = PRIMITIVES[kind](shape)
        else:
            self.complain(f"{name}: the shape {kind} is left out")
            return
        if mesh is None:
            return
        points, polygons = mesh
        matrix = to_world(shape)
        flip = any(part.get("name") in ("flipNormals", "flip_normals") and part.get("value") == "true" for part in shape)
        flip ^= determinant(matrix) < 0  # a mirrored copy keeps its front
        first = len(self.vertices) + 1
        for x, y, z in points:
            self.vertices.append([sum(a * b for a, b in zip(row, (x, y, z, 1))) for row in matrix[:3]])
        self.lines += [f"g {'_'.join(name.split())}_{number}", f"usemtl {self.material(shape, name)}"]
        for polygon in polygons:
            corners = polygon[::-1] if flip else polygon
            self.lines.append("f " + " ".join(str(first + corner) for corner in corners))
        self.faces += len(polygons)

    def read_mesh(self, shape):
        """Points and polygons of an OBJ file; None when it is missing."""
        name = next(part.get("value") for part in shape if part.get("name") == "filename")
        file = self.file.parent / name
        if not file.is_file():
            self.complain(f"{name}: the mesh is missing")
            return None
        points, polygons = [], []
        for line in file.read_text(errors="replace").splitlines():
            words = line.split()
            if words[:1] == ["v"]:
                points.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) for word in words[1:]]
                polygons.append([corner - 1 if corner > 0 else len(points) + corner for corner in corners])
        return points, polygons

    def read(self):
        root = ElementTree.parse(self.file).getroot()
        for bsdf in root.iter("bsdf"):
            if bsdf.get("id"):
                self.bsdfs[bsdf.get("id")] = bsdf
        for emitter in root.findall("emitter"):
            self.complain(f"the emitter {emitter.get('type')} is left out")
        for number, shape in enumerate(root.findall("shape"), 1):
            self.add_shape(shape, number)

    def write(self, file):
        library = file.with_suffix(".mtl")
        with open(library, "w") as out:
            for name, (rho, radiance) in self.materials.items():
                out.write(f"newmtl {name}\nKd {text_of(rho)}\n")
                if any(radiance):
                    out.write(f"Ke {text_of(radiance)}\n")
        with open(file, "w") as out:
            out.write(f"mtllib {library.name}\n")
            out.writelines(f"v {text_of(vertex)}\n" for vertex in self.vertices)
            out.write("\n".join(self.lines) + "\n")


def text_of(values):
    return " ".join(f"{value:.9g}" for value in values)


def srgb_to_linear(value):
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055)**2.4


def rectangle(_):
    """From -1 to 1 in x and y; its front looks along +z."""
    return [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [[0, 1, 2, 3]]


def cube(_):
    """From -1 to 1; fronts outward."""
    points = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return points, [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def disk(_):
    """Radius 1 in the plane z = 0; its front looks along +z."""
    angles = [2 * math.pi * k / FACETS for k in range(FACETS)]
    return [(math.cos(angle), math.sin(angle), 0) for angle in angles], [list(range(FACETS))]


def sphere(shape):
    """Facets with corners on the sphere: a pole, rings, a pole."""
    values = {part.get("name"): part for part in shape}
    center = vector(values["center"], 0) if "center" in values else [0, 0, 0]
    radius = float(values["radius"].get("value")) if "radius" in values else 1.0
    rings = FACETS // 2 - 1
    points = [(0, 0, -1)]
    for ring in range(1, rings + 1):
        polar = math.pi * ring / (rings + 1)
        for k in range(FACETS):
            angle = 2 * math.pi * k / FACETS
            points.append((math.sin(polar) * math.cos(angle), math.sin(polar) * math.sin(angle), -math.cos(polar)))
    points.append((0, 0, 1))
    polygons = []
    for k in range(FACETS):
        following = (k + 1) % FACETS
        polygons.append([0, 1 + following, 1 + k])
        for ring in range(rings - 1):
            low, high = 1 + ring * FACETS, 1 + (ring + 1) * FACETS
            polygons.append([low + k, low + following, high + following, high + k])
        last = 1 + (rings - 1) * FACETS
        polygons.append([last + k, last + following, len(points) - 1])
    return [[c + radius * x for c, x in zip(center, point)] for point in points], polygons


PRIMITIVES = {"rectangle": rectangle, "cube": cube, "disk": disk, "sphere": sphere}


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__.strip())
    source, target = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    scene = Scene(source)
    try:
        scene.read()
    except (OSError, ElementTree.ParseError, ValueError, StopIteration) as error:
        sys.exit(f"{source}: cannot be converted: {error or 'a shape has no filename'}")
    if scene.faces == 0:
        sys.exit(f"{source}: found no shapes that can be converted")
    scene.write(target)
    for complaint in scene.complaints:
        print(f"{source}: {complaint}", file=sys.stderr)
    lamps = sum(1 for _, radiance in scene.materials.values() if any(radiance))
    print(f"{target}: {scene.faces} faces, {len(scene.materials)} materials, {lamps} of them lamps")


if __name__ == "__main__":
    main()
