"""scripts/mitsuba_to_obj.py: transformations, materials, lamps, and naming what is lost."""
import pathlib
import subprocess
import sys
import unittest

from support import ToolTest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "mitsuba_to_obj.py"

SCENE = """<?xml version="1.0"?>
<scene version="0.5.0">
  <bsdf type="twosided" id="Red"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.1, 0.2"/></bsdf></bsdf>
  <bsdf type="roughconductor" id="Metal"><rgb name="specularReflectance" value="0.7 0.7 0.7"/></bsdf>
  <shape type="rectangle">
    <transform name="toWorld">
      <scale x="2" y="3"/><rotate x="1" angle="90"/><translate x="10" y="20" z="30"/>
    </transform>
    <ref id="Red"/>
    <emitter type="area"><rgb name="radiance" value="5, 6, 7"/></emitter>
  </shape>
  <shape type="cube"><ref id="Metal"/></shape>
  <shape type="sphere"><float name="radius" value="2"/><ref id="Red"/></shape>
  <shape type="obj"><string name="filename" value="part.obj"/>
    <transform name="toWorld"><matrix value="-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform><ref id="Red"/></shape>
  <shape type="obj"><string name="filename" value="absent.obj"/><ref id="Red"/></shape>
  <emitter type="sunsky"/>
</scene>
"""


class MitsubaTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("scene.xml", SCENE)
        self.write("part.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3/1/1 -2/1/1 -1/1/1\n")
        command = [sys.executable, str(SCRIPT), "scene.xml", "out.obj"]
        self.done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=600, check=False)
        self.assertEqual(self.done.returncode, 0, self.done.stderr)
        self.vertices, self.faces = [], {}
        for line in (self.folder / "out.obj").read_text().splitlines():
            key, *words = line.split()
            if key == "v":
                self.vertices.append([float(word) for word in words])
            elif key == "g":
                group = self.faces.setdefault(words[0], [])
            elif key == "f":
                group.append([self.vertices[int(word) - 1] for word in words])

    def test_steps_of_a_transformation_apply_in_their_order(self):
        (corners,) = self.faces["rectangle_1"]
        # Scaled to 4 x 6, then z turned up from y, then moved: x 8 to 12, y 20, z 27 to 33.
        expected = [[8, 20, 27], [12, 20, 27], [12, 20, 33], [8, 20, 33]]
        for corner, point in zip(corners, expected):
            for value, wanted in zip(corner, point):
                self.assertAlmostEqual(value, wanted, places=7)

    def test_closed_shapes_have_their_volume(self):
        """(1/3) sum p . A over triangles: 8 for the cube; the facets of the sphere lie inside it, by some percent."""
        self.assertAlmostEqual(self.volume("cube_2"), 8)
        sphere = 4 / 3 * 3.141592653589793 * 8
        self.assertTrue(0.95 * sphere < self.volume("sphere_3") < sphere)

    def volume(self, group):
        total = 0.0
        for corners in self.faces[group]:
            a = corners[0]
            for b, c in zip(corners[1:], corners[2:]):
                total += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                          + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
        return total

    def test_a_mirrored_mesh_keeps_its_front(self):
        (corners,) = self.faces["part_4"]
        (ax, ay, _), (bx, by, _), (cx, cy, _) = corners
        self.assertGreater((bx - ax) * (cy - ay) - (by - ay) * (cx - ax), 0)

    def test_materials(self):
        text = (self.folder / "out.mtl").read_text()
        self.assertIn("Kd 0.6 0.1 0.2\nKe 5 6 7\n", text)
        self.assertIn("newmtl Metal\nKd 0.7 0.7 0.7\n", text)

    def test_what_is_lost_is_named(self):
        for part in ("roughconductor", "absent.obj", "sunsky"):
            self.assertIn(part, self.done.stderr)


if __name__ == "__main__":
    unittest.main()
