"""Walls with windows in five formats: the same area, and the same light through the openings."""
import json
import math
import random
import struct
import unittest

from support import ToolTest

WALLS = 200
FORMATS = ("hbjson", "xml", "ifc", "gltf", "obj")
THICKNESS = 0.2  # of IFC walls, m


class Wall:
    """A wall with columns of windows, each around the middle line of its column. Lengths are whole millimeters."""

    def __init__(self, name, generator, windows, size=None, place=(0, 0, 0, 0)):
        self.name = name
        self.width, self.height = size or (generator.randrange(3000, 12000) / 1000, generator.randrange(2400, 6000) / 1000)
        self.x, self.y, self.z, self.angle = place
        self.columns = self.random_columns(generator, windows)

    def random_columns(self, generator, windows):
        """The middle of each column and its windows from the bottom up, (left, right, bottom, top)."""
        number = generator.randint(1, windows)
        counts = [windows // number + (k < windows % number) for k in range(number)]
        columns, wide = [], self.width / number
        for column, count in enumerate(counts):
            middle, high, stack = (column + 0.5) * wide, self.height / count, []
            for row in range(count):
                left, right = (generator.uniform(0.1, 0.45) * wide for _ in range(2))
                bottom, top = generator.uniform(0.05, 0.4) * high, generator.uniform(0.6, 0.95) * high
                stack.append([round(v, 3) for v in (middle - left, middle + right, row * high + bottom, row * high + top)])
            columns.append((round(middle, 3), stack))
        return columns

    def windows(self):
        return [window for _, stack in self.columns for window in stack]

    def area(self):
        return self.width * self.height - sum((b - a) * (d - c) for a, b, c, d in self.windows())

    def rims(self):
        return 2 * (self.width + self.height) + sum(2 * (b - a + d - c) for a, b, c, d in self.windows())

    def point(self, u, v, w=0):
        """The point with the wall's coordinates along, up and across it."""
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        return [self.x + u * cos - w * sin, self.y + u * sin + w * cos, self.z + v]

    def outline(self):
        return [(0, 0), (self.width, 0), (self.width, self.height), (0, self.height)]

    def seamed(self):
        """One outline of the wall with a seam to every window, which it follows twice."""

        def around(middle, stack):
            if not stack:
                return []
            (a, b, c, d), above = stack[0], stack[1:]
            return [(middle, c), (a, c), (a, d), (middle, d), *around(middle, above),
                    *([(middle, d)] if above else []), (b, d), (b, c), (middle, c)]

        corners = [(0, 0)]
        for middle, stack in self.columns:
            corners += [(middle, 0), *around(middle, stack), (middle, 0)]
        return [*corners, (self.width, 0), (self.width, self.height), (0, self.height)]

    def cells(self):
        """Rectangles of the grid of all edges that lie in no window."""
        windows = self.windows()
        us = sorted({0, self.width, *(v for window in windows for v in window[:2])})
        vs = sorted({0, self.height, *(v for window in windows for v in window[2:])})
        for left, right in zip(us, us[1:]):
            for low, high in zip(vs, vs[1:]):
                u, v = (left + right) / 2, (low + high) / 2
                if not any(a < u < b and c < v < d for a, b, c, d in windows):
                    yield left, right, low, high

    def triangles(self):
        for left, right, low, high in self.cells():
            yield (left, low), (right, low), (right, high)
            yield (left, low), (right, high), (left, high)


def rectangle(window):
    left, right, low, high = window
    return [(left, low), (right, low), (right, high), (left, high)]


def hbjson(walls, panes=True):
    def face(wall):
        geometry = {"type": "Face3D", "boundary": [wall.point(*p) for p in wall.outline()]}
        apertures = [{"type": "Aperture", "identifier": f"{wall.name}_pane{k}", "boundary_condition": {"type": "Outdoors"},
                      "geometry": {"type": "Face3D", "boundary": [wall.point(*p) for p in rectangle(window)]}}
                     for k, window in enumerate(wall.windows())]
        if not panes:
            geometry["holes"] = [[wall.point(*p) for p in rectangle(window)] for window in wall.windows()]
        return {"type": "Face", "identifier": wall.name, "face_type": "Wall", "geometry": geometry,
                "boundary_condition": {"type": "Outdoors"}, "apertures": apertures if panes else []}

    return json.dumps({"type": "Model", "units": "Meters", "orphaned_faces": [face(wall) for wall in walls]})


def xml(walls, panes=True):
    def loop(wall, corners):
        points = "".join("<CartesianPoint>" + "".join(f"<Coordinate>{v!r}</Coordinate>" for v in wall.point(*p)) +
                         "</CartesianPoint>" for p in corners)
        return f"<PlanarGeometry><PolyLoop>{points}</PolyLoop></PlanarGeometry>"

    text = '<gbXML lengthUnit="Meters"><Campus id="c"><Building id="b"/>\n'
    for wall in walls:
        openings = "".join(f'<Opening openingType="{"FixedWindow" if panes else "Air"}" id="{wall.name}_pane{k}">' +
                           loop(wall, rectangle(window)) + "</Opening>\n" for k, window in enumerate(wall.windows()))
        text += (f'<Surface surfaceType="ExteriorWall" id="{wall.name}">' + loop(wall, wall.outline()) + openings +
                 "</Surface>\n")
    return text + "</Campus></gbXML>\n"


class IfcFile:
    def __init__(self, thickness):
        self.thickness, self.lines = thickness, []
        self.origin = self.placed([0, 0, 0], "$", "$")
        self.placement = self.add(f"IFCLOCALPLACEMENT($,{self.origin})")
        self.context = self.add(f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,{self.origin},$)")
        units = self.add("IFCUNITASSIGNMENT((" + self.add("IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)") + "))")
        project = self.add(f"IFCPROJECT('project',$,'p',$,$,$,$,({self.context}),{units})")
        storey = self.add(f"IFCBUILDINGSTOREY('storey',$,'s',$,$,{self.placement},$,$,.ELEMENT.,0.)")
        self.add(f"IFCRELAGGREGATES('r',$,$,$,{project},({storey}))")
        self.storey, self.up = storey, self.add("IFCDIRECTION((0.,0.,1.))")

    def add(self, entity):
        self.lines.append(f"#{len(self.lines) + 1}={entity};\n")
        return f"#{len(self.lines)}"

    def vector(self, kind, values):
        return self.add(f"{kind}((" + ",".join(repr(float(v)) for v in values) + "))")

    def placed(self, place, axis, along):
        return self.add(f"IFCAXIS2PLACEMENT3D({self.vector('IFCCARTESIANPOINT', place)},{axis},{along})")

    def body(self, wall, corners, beyond):
        """The outline, extruded through the wall and beyond it on both sides."""
        points = [self.vector("IFCCARTESIANPOINT", corner) for corner in corners]
        profile = self.add("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$," +
                           self.add(f"IFCPOLYLINE(({','.join([*points, points[0]])}))") + ")")
        cos, sin = math.cos(wall.angle), math.sin(wall.angle)
        place = self.placed(wall.point(0, 0, beyond), self.vector("IFCDIRECTION", (sin, -cos, 0)),
                            self.vector("IFCDIRECTION", (cos, sin, 0)))
        solid = self.add(f"IFCEXTRUDEDAREASOLID({profile},{place},{self.up},{self.thickness + 2 * beyond!r})")
        shape = self.add(f"IFCSHAPEREPRESENTATION({self.context},'Body','SweptSolid',({solid}))")
        return self.add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({shape}))")

    def element(self, kind, name, body):
        return self.add(f"{kind}('{len(self.lines):022d}',$,'{name}',$,$,{self.placement},{body},$,$)")

    def add_wall(self, wall):
        number = self.element("IFCWALL", wall.name, self.body(wall, wall.outline(), 0))
        self.add(f"IFCRELCONTAINEDINSPATIALSTRUCTURE('{len(self.lines):022d}',$,$,$,({number}),{self.storey})")
        for window in wall.windows():
            opening = self.element("IFCOPENINGELEMENT", "opening", self.body(wall, rectangle(window), 0.05))
            self.add(f"IFCRELVOIDSELEMENT('{len(self.lines):022d}',$,$,$,{number},{opening})")

    def text(self):
        return ("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
                "FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n" + "".join(self.lines) + "ENDSEC;\nEND-ISO-10303-21;\n")


def ifc(walls, thickness=THICKNESS):
    file = IfcFile(thickness)
    for wall in walls:
        file.add_wall(wall)
    return file.text()


def gltf(walls):
    """Triangles in single precision below a node for each wall, y up."""
    data, accessors, meshes, nodes = b"", [], [], []
    for wall in walls:
        points = [(u, v, 0) for triangle in wall.triangles() for u, v in triangle]
        accessors.append({"bufferView": 0, "byteOffset": len(data), "componentType": 5126, "count": len(points),
                          "type": "VEC3"})
        data += b"".join(struct.pack("<3f", *point) for point in points)
        meshes.append({"primitives": [{"attributes": {"POSITION": len(meshes)}}]})
        nodes.append({"name": wall.name, "mesh": len(nodes), "translation": [wall.x, wall.z, -wall.y],
                      "rotation": [0, math.sin(wall.angle / 2), 0, math.cos(wall.angle / 2)]})
    document = {"asset": {"version": "2.0"}, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
                "meshes": meshes, "accessors": accessors, "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
                "buffers": [{"byteLength": len(data), "uri": "walls.bin"}]}
    return json.dumps(document), data


def obj(walls):
    """Polygons with seams, alternating with triangles."""
    text, vertices = "", 0
    for k, wall in enumerate(walls):
        text += f"g {wall.name}\n"
        for corners in [wall.seamed()] if k % 2 == 0 else list(wall.triangles()):
            for corner in corners:
                text += "v " + " ".join(repr(v) for v in wall.point(*corner)) + "\n"
            text += "f " + " ".join(str(vertices + 1 + j) for j in range(len(corners))) + "\n"
            vertices += len(corners)
    return text


BOX = """v 0 -3 0
v 4 -3 0
v 4 3 0
v 0 3 0
v 0 -3 2.5
v 4 -3 2.5
v 4 3 2.5
v 0 3 2.5
v 1.5 -2 2.4
v 2.5 -2 2.4
v 2.5 -1 2.4
v 1.5 -1 2.4
g box
usemtl shell
f 1 2 3 4
f 8 7 6 5
f 5 6 2 1
f 6 7 3 2
f 7 8 4 3
f 8 5 1 4
g lamp
usemtl lamp
f 12 11 10 9
"""
ROOMS = """up = "z"
[[model]]
file = "box.obj"
[[model]]
file = "wall.{0}"
{1}
[[material]]
name = "*"
reflectance = 0.5
[[material]]
name = "lamp"
reflectance = 0
radiance = 10
[[sensors]]
name = "beyond"
corner = [0.5, 0.5, 0.8]
edges = [[3, 0, 0], [0, 2, 0]]
spacing = 0.5
"""


class OpeningsTest(ToolTest):
    def write_walls(self, stem, walls, panes, thickness):
        self.write(f"{stem}.hbjson", hbjson(walls, panes))
        self.write(f"{stem}.xml", xml(walls, panes))
        self.write(f"{stem}.ifc", ifc(walls, thickness))
        self.write(f"{stem}.obj", obj(walls))
        document, data = gltf(walls)
        self.write(f"{stem}.gltf", document)
        (self.folder / "walls.bin").write_bytes(data)

    def areas(self, name):
        """The area of each wall as read, and the problems of the model."""
        done = self.run_tool("check", name, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        areas = {}
        for entry in report["objects"]:
            key = entry["name"].split("_")[1] if name.endswith("ifc") else entry["name"]
            areas[key] = areas.get(key, 0) + entry["area_m2"]
        return areas, report["problems"]

    def test_walls_with_windows_have_one_area_in_all_formats(self):
        generator = random.Random(2026)
        walls = [Wall(f"wall{k}", generator, 1 + k % 12,
                      place=(15 * (k % 20), 15 * (k // 20), generator.uniform(-2, 2), generator.uniform(0, 6.28)))
                 for k in range(WALLS)]
        self.write_walls("walls", walls, True, THICKNESS)
        for extension in FORMATS:
            areas, problems = self.areas(f"walls.{extension}")
            self.assertEqual([p for p in problems if "left_out" in p["kind"]], [], extension)
            for wall in walls:
                area = areas.get(wall.name, 0)
                if extension == "ifc":  # both sides and all rims
                    area = (area - THICKNESS * wall.rims()) / 2
                self.assertLess(abs(area / wall.area() - 1), 1e-6, f"{extension} {wall.name} {wall.windows()}")

    def test_one_light_goes_through_the_openings_of_all_formats(self):
        generator = random.Random(7)
        self.write("box.obj", BOX)
        for windows in (5,):
            wall = Wall("wall", generator, windows, size=(4, 2.5))
            self.write_walls("wall", [wall], False, 1e-3)
            means = {}
            for extension in FORMATS:
                turned = 'rotate = [{ axis = "x", degrees = 90 }]' if extension == "gltf" else ""
                self.write("rooms.toml", ROOMS.format(extension, turned))
                done = self.run_tool("solve", "rooms.toml", "--patches", 1500, "--no-refine", "--json", "report.json",
                                     "-q")
                self.assertEqual((done.returncode, done.stderr), (0, ""), extension)
                group = json.loads((self.folder / "report.json").read_text())["sensors"]["groups"][0]
                means[extension] = group["mean"], group["standard_error_of_mean"]
            for one, error in means.values():
                for other, other_error in means.values():
                    self.assertLess(abs(one - other), 3 * math.hypot(error, other_error), means)


if __name__ == "__main__":
    unittest.main()
