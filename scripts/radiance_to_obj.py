#!/usr/bin/env python3
"""Turns Radiance scene files into one OBJ file and one MTL file beside it, in the unit of the scene.

usage: scripts/radiance_to_obj.py OUT.obj SCENE.rad...

The files are read in their order, as by oconv: materials first. Polygons are carried over with their outlines as they
are (holes by coincident edges), and files that !xform lines name. A material becomes its reflectance, a light its
radiance (Ke), glass a pane (Tf, Ni, illum 7), mirror and smooth metal a mirror (Ks, illum 3). What trans lets straight
through, or, if nothing goes straight, scatters through, is printed as the --set that does so. What cannot be carried over is named on stderr; what cannot be read is
refused with file and line.
"""
import math
import pathlib
import re
import sys

IDENTITY = [[float(i == j) for j in range(4)] for i in range(3)]
LEFT_OUT = ("sphere", "bubble", "cylinder", "tube", "cone", "cup", "ring", "source", "instance", "mesh")
LIGHTS = ("light", "glow", "illum", "spotlight")
ARGUMENTS = {"plastic": 5, "metal": 5, "trans": 7, "glass": 3, "mirror": 3, "light": 3, "illum": 3, "glow": 4,
             "spotlight": 7}
INDEX = 1.52  # of refraction, of Radiance's glass unless its fourth number states another


class Refusal(Exception):
    """A sentence with file and line."""


class Words:
    """The words of a file with their lines; comments, and !commands as one word each."""

    def __init__(self, file):
        self.file, self.words, self.next = file, [], 0
        try:
            text = file.read_text(errors="replace")
        except OSError as error:
            raise Refusal(f"{file}: cannot be read: {error.strerror}") from error
        lines = text.splitlines()
        for number, line in enumerate(lines, 1):
            if line.lstrip().startswith("!"):
                while line.endswith("\\") and number < len(lines):
                    line, lines[number] = line[:-1] + lines[number], ""
                    number += 1
                self.words.append((line.strip(), number))
                continue
            for word in re.findall(r'"[^"]*"|\S+', line):
                if word.startswith("#"):
                    break
                self.words.append((word, number))

    def more(self):
        return self.next < len(self.words)

    def take(self, what):
        if not self.more():
            self.next = len(self.words)
            raise self.refusal(f"the file ends where {what} is expected")
        self.next += 1
        return self.words[self.next - 1][0]

    def refusal(self, text):
        line = self.words[max(0, self.next - 1)][1] if self.words else 1
        return Refusal(f"{self.file}:{line}: {text}")

    def number(self, what, kind=float):
        word = self.take(what)
        try:
            value = kind(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.refusal(f"found '{word}' where {what} is expected")
        return value

    def list_of(self, what, read):
        count = self.number(f"the number of {what}", int)
        if count < 0:
            raise self.refusal(f"the number of {what} is {count}")
        return [read() for _ in range(count)]


def glass_of(transmissivity, index):
    """Transmittance of a pane, square to it: Fresnel at both faces, and all reflections between.

    The Radiance Reference Manual (material glass) has the inverse for the index 1.52, the transmissivity of a
    transmittance T: (sqrt(.8402528435 + .0072522239 T^2) - .9166530661) / .0036261119 / T, with (1 - r)^4, 4 r^2,
    (1 - r)^2 and 2 r^2.
    """
    r = ((index - 1) / (index + 1))**2
    through = 1 - (r * transmissivity)**2
    return (1 - r)**2 * transmissivity / through


class Modifier:
    """A material, or a pattern or texture; of an alias, what it stands for."""

    def __init__(self, under, kind, arguments):
        self.under, self.kind, self.arguments = under, kind, arguments


class Scene:
    """What is read, and what could not be."""

    def __init__(self):
        self.modifiers = {}
        self.materials = {}  # name: (reflectance, transmittance, radiance)
        self.scattered_through = {}  # the diffuse transmittance of translucent sheets
        self.index = {}      # of refraction, of those that are glass
        self.specular = {}   # reflectance, of those that are mirrors
        self.left_out = {}   # kind: names
        self.vertices, self.lines, self.polygons, self.complaints = [], [], 0, []

    def complain(self, text):
        if text not in self.complaints:
            self.complaints.append(text)

    def read(self, file, matrix, material, prefix):
        words = Words(file)
        while words.more():
            word = words.take("a primitive")
            if word.startswith("!"):
                self.run(words, word, (matrix, material, prefix))
            else:
                self.primitive(words, word, (matrix, material, prefix))

    def primitive(self, words, under, frame):
        matrix, material, prefix = frame
        kind, name = words.take("a kind"), words.take("a name")
        if kind == "alias":
            self.modifiers[name] = self.modifiers.get(words.take("the name of a material"))
            return
        words.list_of("words", lambda: words.take("a word"))
        words.list_of("whole numbers", lambda: words.number("a whole number", int))
        values = words.list_of("numbers", lambda: words.number("a number"))
        if kind == "polygon":
            self.add_polygon(words, (prefix + name, material or under), values, matrix)
        elif kind in LEFT_OUT:
            self.left_out.setdefault(kind, []).append(prefix + name)
        else:
            if len(values) < ARGUMENTS.get(kind, 0):
                raise words.refusal(f"{kind} {name} has {len(values)} numbers, {ARGUMENTS[kind]} are expected")
            if name in self.materials and self.modifiers[name].arguments != values:
                raise words.refusal(f"{kind} {name} is defined anew, after polygons of that name; rename one")
            self.modifiers[name] = Modifier(under, kind, values)

    def run(self, words, command, frame):
        """A line that starts a program: xform with a file, nothing else."""
        arguments = command[1:].split()
        if arguments[:1] != ["xform"] or "|" in command:
            raise words.refusal(f"only !xform is understood; run '{command[1:]}' and put what it prints in its place")
        matrix, material, prefix = frame
        own, k = IDENTITY, 1
        try:
            while k < len(arguments) and arguments[k].startswith("-"):
                option = arguments[k]
                if option in ("-m", "-n"):
                    material = material or (arguments[k + 1] if option == "-m" else None)
                    prefix += arguments[k + 1] + "." if option == "-n" else ""
                    k += 2
                else:
                    step, used = step_matrix(option, arguments[k + 1:])
                    own, k = multiply(step, own), k + 1 + used
        except (ValueError, IndexError) as error:
            raise words.refusal(f"'{arguments[k]}' of xform is not understood, or lacks a number") from error
        if k == len(arguments):
            raise words.refusal("xform without a file")
        for name in arguments[k:]:
            beside = words.file.parent / name
            self.read(beside if beside.is_file() else pathlib.Path(name), multiply(matrix, own), material, prefix)

    def add_polygon(self, words, names, values, matrix):
        name, material = names
        if len(values) < 9 or len(values) % 3:
            raise words.refusal(f"polygon {name} has {len(values)} numbers; expected are three for each of its "
                                "corners, nine at least")
        if material not in self.materials:
            self.materials[material] = self.material(words, name, material)
        corners = [values[k:k + 3] + [1] for k in range(0, len(values), 3)]
        points = [[sum(a * b for a, b in zip(row, corner)) for row in matrix] for corner in corners]
        if determinant(matrix) < 0:  # a mirrored copy keeps its front
            points.reverse()
        first = len(self.vertices) + 1
        self.vertices += points
        self.lines += [f"o {name}", f"usemtl {material}", "f " + " ".join(str(first + k) for k in range(len(points)))]
        self.polygons += 1

    def material(self, words, polygon, name):
        """Reflectance, transmittance and radiance, three bands each."""
        found = self.modifiers.get(name)
        if found is None:
            raise words.refusal(f"the material {name} of polygon {polygon} is not defined; name the file that "
                                "defines it before this one")
        if found.kind not in ARGUMENTS:
            raise words.refusal(f"the material {name} of polygon {polygon} is of the kind {found.kind}; expected is "
                                "one of " + ", ".join(ARGUMENTS))
        if found.under != "void":
            self.complain(f"{name}: its pattern or texture {found.under} is left out")
        color, rest, black = found.arguments[:3], found.arguments[3:], [0.0] * 3
        if found.kind in LIGHTS:
            if found.kind != "light":
                self.complain(f"{name}: {found.kind} is taken for a matt light, the same in all directions")
            return black, black, color
        if found.kind == "glass":
            self.index[name] = index = rest[0] if rest else INDEX
            return black, [glass_of(t, index) for t in color], black
        if found.kind == "trans":
            return self.sheet(name, color, rest), [c * (1 - rest[0]) * rest[2] * rest[3] for c in color], black
        if found.kind == "mirror":
            self.specular[name] = color
            return black, black, black
        if found.kind == "metal" and rest[0] > 0 and rest[1] == 0:
            self.specular[name] = [c * rest[0] for c in color]
            return [c * (1 - rest[0]) for c in color], black, black
        if rest[0] > 0:
            self.complain(f"{name}: its gloss ({found.kind}) becomes matt")
        gloss = rest[0] if found.kind == "plastic" else 0.0  # of a metal the gloss has its colour
        return [c * (1 - gloss) + gloss for c in color], black, black

    def sheet(self, name, color, rest):
        """The reflectance of a trans material; gloss, roughness, share let through, share of that not scattered."""
        gloss, _, through, straight = rest
        if gloss > 0:
            self.complain(f"{name}: its gloss (trans) becomes matt")
        if straight == 0 and through > 0:
            self.scattered_through[name] = [c * (1 - gloss) * through for c in color]
        elif through * (1 - straight) > 0:
            self.complain(f"{name}: the light it lets through scattered is lost")
        return [c * (1 - gloss) * (1 - through) + gloss for c in color]

    def write(self, file):
        library = file.with_suffix(".mtl")
        library.write_text("".join(self.statements(name) for name in self.materials))
        vertices = [f"v {text_of(vertex)}" for vertex in self.vertices]
        file.write_text("\n".join([f"mtllib {library.name}", *vertices, *self.lines]) + "\n")

    def statements(self, name):
        """A material of the MTL file."""
        rho, tau, light = self.materials[name]
        lines = [f"newmtl {name}", f"Kd {text_of(rho)}"]
        lines += [f"Ke {text_of(light)}"] if any(light) else []
        if name in self.index:
            lines += [f"Tf {text_of(tau)}", f"Ni {self.index[name]:.9g}", "illum 7"]
        if name in self.specular:
            lines += [f"Ks {text_of(self.specular[name])}", "illum 3"]
        return "".join(line + "\n" for line in lines)


def text_of(values):
    return " ".join(f"{value:.9g}" for value in values)


def multiply(a, b):
    """a after b; the last row, 0 0 0 1, is not kept."""
    return [[sum(row[k] * b[k][j] for k in range(3)) + (row[3] if j == 3 else 0) for j in range(4)] for row in a]


def determinant(m):
    (a, b, c), (d, e, f), (g, h, i) = (row[:3] for row in m)
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def step_matrix(option, words):
    """The matrix of one option of xform, and how many words it takes; ValueError if it is not known."""
    axis = "xyz".find(option[2:]) if len(option) == 3 else -1
    matrix = [row[:] for row in IDENTITY]
    if option == "-t":
        for row, shift in zip(matrix, [float(words[k]) for k in range(3)]):
            row[3] = shift
        return matrix, 3
    if option == "-s":
        return [[float(words[0]) * value for value in row] for row in matrix], 1
    if option[:2] == "-m" and axis >= 0:
        matrix[axis][axis] = -1.0
        return matrix, 0
    if option[:2] == "-r" and axis >= 0:
        c, s = math.cos(math.radians(float(words[0]))), math.sin(math.radians(float(words[0])))
        u, v = (axis + 1) % 3, (axis + 2) % 3
        matrix[u][u], matrix[u][v], matrix[v][u], matrix[v][v] = c, -s, s, c
        return matrix, 1
    raise ValueError(option)


def main():
    if len(sys.argv) < 3 or not sys.argv[1].endswith(".obj"):
        sys.exit(__doc__.strip())
    target, scene = pathlib.Path(sys.argv[1]), Scene()
    try:
        for file in sys.argv[2:]:
            scene.read(pathlib.Path(file), IDENTITY, None, "")
    except Refusal as refusal:
        sys.exit(f"error: {refusal}")
    if scene.polygons == 0:
        sys.exit(f"error: {sys.argv[2]}: found no polygons")
    scene.write(target)
    for kind, names in scene.left_out.items():
        more = f" and {len(names) - 5} more" if len(names) > 5 else ""
        scene.complain(f"left out, of the kind {kind}: {len(names)} ({', '.join(names[:5])}{more})")
    for complaint in scene.complaints:
        print(complaint, file=sys.stderr)
    lamps = sum(any(light) for _, _, light in scene.materials.values())
    print(f"{target}: {scene.polygons} polygons, {len(scene.materials)} materials, {lamps} of them lamps")
    straight = {name: tau for name, (_, tau, _) in scene.materials.items() if name not in scene.index}
    for quantity, shares in (("transmittance", straight), ("diffuse_transmittance", scene.scattered_through)):
        for name, tau in shares.items():
            if any(tau):
                bands = tau[:1] if len(set(tau)) == 1 else tau
                print(f"--set {name}.{quantity}={','.join(f'{t:.4g}' for t in bands)}")


if __name__ == "__main__":
    main()
