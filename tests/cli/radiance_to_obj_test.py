"""scripts/radiance_to_obj.py: transformations, materials, glass, naming what is lost, refusing what cannot be read."""
import json
import math
import pathlib
import subprocess
import sys
import unittest

from support import ToolTest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "radiance_to_obj.py"

MATERIALS = """# a comment
void plastic wall 0 0 5 .5 .25 .125 0 0
void plastic shiny
0
0
5 .5 .5 .5 .1 .05
void glass pane 0 0 3 .654 .654 .654
void trans sheet 0 0 7 .8 .8 .8 0 0 .5 .25
void mirror polished 0 0 3 .9 .8 .7
void metal chrome 0 0 5 .8 .6 .4 .75 0
void metal brushed 0 0 5 .8 .6 .4 .75 .1
void light lamp 0 0 3 5 6 7
void dielectric water 0 0 5 1 1 1 1.33 0
void alias paint wall
"""
PART = "lamp polygon triangle 0 0 9  0 0 0  1 0 0  0 2 0  # its front looks up\n"
SCENE = r"""
paint polygon floor 0 0 12 0 0 0  4 0 0  4 3 0  0 3 0
shiny polygon shelf 0 0 9 0 0 1  1 0 1  0 1 1
pane polygon window 0 0 9 0 0 1  1 0 1  0 0 2
sheet polygon blind 0 0 9 0 1 1  1 1 1  0 1 2
water sphere drop 0 0 4 0 0 0 1
!xform -n moved -rz 90 -s 2 -t 10 0 0 \
  parts/part.rad
!xform -n mirrored -m wall -mx parts/part.rad
"""


class RadianceTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("materials.mat", MATERIALS)
        self.write("scene.rad", SCENE)
        (self.folder / "parts").mkdir()
        self.write("parts/part.rad", PART)

    def convert(self, *files):
        command = [sys.executable, str(SCRIPT), "out.obj", *files]
        return subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=600, check=False)

    def faces(self):
        """Corners and material by name."""
        vertices, faces = [], {}
        for line in (self.folder / "out.obj").read_text().splitlines():
            key, *words = line.split()
            if key == "v":
                vertices.append([float(word) for word in words])
            elif key == "o":
                name = words[0]
            elif key == "usemtl":
                material = words[0]
            elif key == "f":
                faces[name] = [vertices[int(word) - 1] for word in words], material
        return faces

    def converted(self):
        done = self.convert("materials.mat", "scene.rad")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def assert_corners(self, found, expected):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y, places=7)

    def test_steps_of_xform_apply_in_their_order(self):
        self.converted()
        corners, material = self.faces()["moved.triangle"]
        # Turned x to y and y to -x, then twice as large, then moved.
        self.assert_corners(corners, [[10, 0, 0], [10, 2, 0], [6, 0, 0]])
        self.assertEqual(material, "lamp")

    def test_a_mirrored_part_keeps_its_front_and_takes_the_material_of_xform(self):
        self.converted()
        corners, material = self.faces()["mirrored.triangle"]
        self.assert_corners(corners, [[0, 2, 0], [-1, 0, 0], [0, 0, 0]])
        self.assertEqual(material, "wall")

    def test_materials(self):
        done = self.converted()
        text = (self.folder / "out.mtl").read_text()
        self.assertIn("newmtl paint\nKd 0.5 0.25 0.125\n", text)
        # 0.5 of what is not reflected by the gloss, and the gloss: 0.5 * 0.9 + 0.1.
        self.assertIn("newmtl shiny\nKd 0.55 0.55 0.55\n", text)
        # Half of 0.8 is let through, a quarter of it straight.
        self.assertIn("newmtl sheet\nKd 0.4 0.4 0.4\n", text)
        self.assertIn("--set sheet.transmittance=0.1\n", done.stdout)
        self.assertIn("newmtl lamp\nKd 0 0 0\nKe 5 6 7\n", text)

    def test_trans_that_lets_nothing_straight_through_is_a_sheet(self):
        self.write("materials.mat", MATERIALS.replace("0 0 .5 .25", "0 0 .5 0"))
        done = self.converted()
        self.assertIn("--set sheet.diffuse_transmittance=0.4\n", done.stdout)
        self.assertNotIn("sheet.transmittance", done.stdout)
        self.assertNotIn("scattered is lost", done.stderr)

    def test_a_pane_lets_through_what_goes_through_both_faces(self):
        """Added up: r is reflected where the light meets a face, t is left after a way through the glass."""
        r, t = (0.52 / 2.52)**2, 0.654
        through = sum((1 - r)**2 * t * (r * t)**(2 * k) for k in range(40))
        done = self.converted()
        self.assertNotIn("--set pane", done.stdout)
        text = (self.folder / "out.mtl").read_text()
        self.assertIn("newmtl pane\nKd 0 0 0\n", text, "what it reflects follows from its index")
        self.assertIn(f"Tf {through:.9g} {through:.9g} {through:.9g}\nNi 1.52\nillum 7\n", text)

    def test_transmissivity_is_that_of_the_reference_manual(self):
        """For each transmittance its formula gives the transmissivity, which gives the transmittance."""
        stated = [0.05, 0.6, 0.88]
        numbers = [(math.sqrt(.8402528435 + .0072522239 * T * T) - .9166530661) / .0036261119 / T for T in stated]
        self.write("materials.mat", MATERIALS.replace(".654 .654 .654", " ".join(map(str, numbers))))
        self.converted()
        (line,) = (line for line in (self.folder / "out.mtl").read_text().splitlines() if line.startswith("Tf"))
        for found, transmittance in zip(line.split()[1:], stated):
            self.assertAlmostEqual(float(found), transmittance, places=6)

    def test_a_fourth_number_of_glass_is_its_index(self):
        """Without absorption 2 n / (n^2 + 1) goes through, and the glass scatters nothing."""
        self.write("materials.mat", MATERIALS.replace("3 .654 .654 .654", "4 1 1 1 1.7"))
        self.converted()
        through = 2 * 1.7 / (1.7**2 + 1)
        text = (self.folder / "out.mtl").read_text()
        self.assertIn("newmtl pane\nKd 0 0 0\n", text)
        self.assertIn(f"Tf {through:.9g} {through:.9g} {through:.9g}\nNi 1.7\n", text)

    def test_mirrors_and_smooth_metals_reflect_without_scattering(self):
        self.write("scene.rad", SCENE + "".join(
            f"{name} polygon {name}_face 0 0 9 0 0 {height}  1 0 {height}  0 1 {height}\n"
            for name, height in (("polished", 3), ("chrome", 4), ("brushed", 5))))
        done = self.converted()
        text = (self.folder / "out.mtl").read_text()
        self.assertIn("newmtl polished\nKd 0 0 0\nKs 0.9 0.8 0.7\nillum 3\n", text)
        # Three quarters of what it reflects, in its colour; the rest is scattered.
        self.assertIn("newmtl chrome\nKd 0.2 0.15 0.1\nKs 0.6 0.45 0.3\nillum 3\n", text)
        self.assertIn("newmtl brushed\nKd 0.8 0.6 0.4\n", text)
        self.assertIn("brushed: its gloss (metal) becomes matt\n", done.stderr)
        self.assertNotIn("chrome", done.stderr)
        report = self.run_tool("check", "out.obj", "--json", "check.json")
        self.assertEqual(report.returncode, 0, report.stderr)
        materials = json.loads((self.folder / "check.json").read_text())["materials"]
        found = {material["name"]: material["specular_reflectance"] for material in materials}
        self.assertEqual([found[name] for name in ("polished", "chrome", "brushed")],
                         [[0.9, 0.8, 0.7], [0.6, 0.45, 0.3], None])

    def test_what_is_lost_is_named(self):
        self.assertEqual(self.converted().stderr.splitlines(), [
            "shiny: its gloss (plastic) becomes matt",
            "sheet: the light it lets through scattered is lost",
            "left out, of the kind sphere: 1 (drop)"])

    def test_what_cannot_be_read_is_refused_with_file_and_line(self):
        for text, message in (
                ("\nnone polygon p 0 0 9 0 0 0 1 0 0 0 1 0", "bad.rad:2: the material none of polygon p is not"),
                ("water polygon p 0 0 9 0 0 0 1 0 0 0 1 0", "bad.rad:1: the material water of polygon p is of"),
                ("wall polygon p 0 0 9 0 0 0 1 0 0\n0 x 0", "bad.rad:2: found 'x' where a number is expected"),
                ("wall polygon p 0 0 8 0 0 0 1 0 0 0 1", "bad.rad:1: polygon p has 8 numbers"),
                ("wall polygon p 0 0 9 0 0 0 1", "bad.rad:1: the file ends where a number is expected"),
                ("void plastic q 0 0 3 1 1 1", "bad.rad:1: plastic q has 3 numbers, 5 are expected"),
                ("\n!genbox wall box 1 1 1", "bad.rad:2: only !xform is understood"),
                ("!xform -a 3 -t 1 0 0 part.rad", "bad.rad:1: '-a' of xform is not understood"),
                ("!xform -t 1 0 0 absent.rad", "absent.rad: cannot be read")):
            self.write("bad.rad", text + "\n")
            done = self.convert("materials.mat", "bad.rad")
            self.assertEqual(done.returncode, 1, text)
            self.assertTrue(done.stderr.startswith("error: " + message), done.stderr)

    def test_the_tool_reads_what_comes_out(self):
        self.converted()
        done = self.run_tool("check", "out.obj", "--json", "check.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("6 polygons", done.stdout)
        materials = json.loads((self.folder / "check.json").read_text())["materials"]
        (pane,) = (material for material in materials if material["name"] == "pane")
        self.assertAlmostEqual(pane["transmittance"][0], 0.599956, places=6)
        self.assertEqual(pane["index"], 1.52)


if __name__ == "__main__":
    unittest.main()
