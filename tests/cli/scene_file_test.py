"""Scene files: the examples of the documentation, the same scene by options, sensors against closed forms, refusals."""
import csv
import json
import math
import os
import pathlib
import re
import unittest

from support import ToolTest

MESHES = pathlib.Path(os.environ["PATCHLIGHT_MESHES"])
PAGE = MESHES.parent / "docs" / "reference" / "scene-file.md"
USAGE, INPUT = 1, 2

# Black ground of 40 x 40 m, so that nothing is reflected.
GROUND = "mtllib ground.mtl\nv -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\no ground\nusemtl black\nf 1 2 3 4\n"
BLACK = "newmtl black\nKd 0 0 0\n"


class SceneFileTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("ground.obj", GROUND)
        self.write("ground.mtl", BLACK)

    def solve(self, *arguments):
        done = self.run_tool("solve", *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def rows(self, name):
        with open(self.folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def readings(self, toml, *options):
        self.write("scene.toml", toml)
        self.solve("scene.toml", "--points-output", "out.csv", *options)
        return self.rows("out.csv")

    def refused(self, code, parts, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)

    def test_sensors_inside_a_wall_are_marked_and_left_out(self):
        # The wall between the two rooms is 0.1 m thick, starts at x = 4, and has a door from y = 1 to 1.9.
        points = ", ".join(f"[{x}, {y}, 0.8, 0, 0, 1]" for x in (3, 4.05, 5) for y in (0.5, 1.4, 2.4))
        rows = self.readings(f'[[model]]\nfile = "{MESHES}/two_rooms.obj"\n[[sensors]]\nname = "plane"\n'
                             f'points = [{points}]\n', "--patches", 500, "--json", "report.json")
        inside = [(float(r["x"]), float(r["y"])) for r in rows if r["inside_wall"] == "1"]
        self.assertEqual(inside, [(4.05, 0.5), (4.05, 2.4)])
        read = [float(r["E_g"]) for r in rows if r["inside_wall"] == "0"]
        self.assertTrue(all(value > 0.01 for value in read))
        self.assertTrue(all(math.isnan(float(r["E_g"])) for r in rows if r["inside_wall"] == "1"))
        group = json.loads((self.folder / "report.json").read_text())["sensors"]["groups"][0]
        self.assertEqual((group["sensors"], group["inside_walls"]), (9, 2))
        self.assertGreater(group["min"], 0.01)

    def test_the_examples_of_the_documentation_are_solved(self):
        examples = re.findall(r"```(?:toml|text)\n# file: (\S+)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
        self.assertEqual([name for name, _ in examples], ["electric.toml", "daylight.toml", "facade.pts"])
        (self.folder / "meshes").symlink_to(MESHES)
        for name, text in examples:
            self.write(name, text)
        sensors = []
        for k, scene in enumerate(("electric.toml", "daylight.toml")):
            self.solve(scene, "--patches", 200, "--points-output", f"{k}.csv", "--points-output", f"{k}.vtp",
                       "--json", f"{k}.json")
            rows = self.rows(f"{k}.csv")
            self.assertTrue(all(float(row["E_v_lx"]) >= 0 for row in rows if row["inside_wall"] == "0"))
            report = json.loads((self.folder / f"{k}.json").read_text())
            self.assertEqual(report["sensors"]["unit"], "lx")
            # A grid over a floor has no sensors in the dividing wall; the rectangle of the Cornell box goes through
            # blocks.
            groups = report["sensors"]["groups"]
            inside = [0, 4][k]
            self.assertEqual([group["inside_walls"] for group in groups], [inside, 0])
            self.assertEqual(len(report["sensors"]["warnings"]), inside)
            self.assertGreater(min(group["uniformity"] for group in groups), 0.2)
            sensors.append([(group["name"], group["sensors"]) for group in groups])
        self.assertEqual([name for name, _ in sensors[0]], ["work plane", "desk"])
        self.assertEqual(sensors[1], [("floor", 25), ("facade", 2)])

    def test_it_is_the_scene_of_the_same_options_to_the_last_bit(self):
        self.write("spots.pts", "0 0 0.3 0 0 1\n0.5 0.2 1.5 1 0 1\n")
        self.write("scene.toml", '[[model]]\nfile = "room.obj"\nunit = "ft"\n[[material]]\nname = "wh*"\n'
                   'reflectance = [0.3, 0.4, 0.5]\n[[material]]\nname = "lamp"\nradiance = 3\n')
        common = ("--patches", 300, "-q", "--points", "spots.pts")
        self.solve("scene.toml", *common, "-o", "a.ply", "--points-output", "a.csv")
        self.write("spots.pts", "0 0 0.984251968503937 0 0 1\n1.6404199475065617 0.6561679790026247 4.921259842519685 1 0 1\n")
        self.solve("room.obj", "--unit", "ft", "--set", "white.reflectance=0.3,0.4,0.5", "--set", "lamp.radiance=3",
                   *common, "-o", "b.ply", "--points-output", "b.csv")
        # Only the bodies, as the headers have different command lines.
        bodies = [(self.folder / name).read_bytes().split(b"end_header\n")[1] for name in ("a.ply", "b.ply")]
        self.assertEqual(bodies[0], bodies[1])
        for a, b in zip(self.rows("a.csv"), self.rows("b.csv")):
            # The points are the same to 1e-16, but not to the last bit.
            self.assertAlmostEqual(float(a["E_r"]), float(b["E_r"]), delta=1e-6 * float(b["E_r"]))

    # E = I h / (h^2 + r^2)^1.5 with I = 10,000 lm / 4 pi at h = 3 m
    def test_a_point_light_has_its_closed_form(self):
        points = ", ".join(f"[{r}, 0, 0.0, 0, 0, 1]" for r in range(6))
        rows = self.readings(f'[[model]]\nfile = "ground.obj"\n[[luminaire]]\nkind = "point"\nposition = [0, 0, 3]\n'
                             f'lumens = 10000\n[[sensors]]\npoints = [{points}]\n', "--patches", 10)
        for r, row in enumerate(rows):
            expected = 10000 / (4 * math.pi) * 3 / (9 + r * r) ** 1.5
            self.assertAlmostEqual(float(row["E_v_lx"]), expected, delta=1e-6 * expected)
            self.assertEqual(float(row["SE_v_lx"]), 0)
        self.assertEqual([round(float(row["E_v_lx"]), 2) for row in rows], [88.42, 75.49, 50.93, 31.26, 19.10, 12.04])

    def test_under_an_open_overcast_sky_daylight_factors_are_known(self):
        rows = self.readings('up = "z"\n[[model]]\nfile = "ground.obj"\n[sky]\nkind = "overcast"\nilluminance = 10000\n'
                             '[[sensors]]\npoints = [[0, 0, 1, 0, 0, 1], [0, 0, 1, 1, 0, 0]]\n', "--patches", 10)
        # A horizontal plane receives all of it; a facade over black ground 39.62 % (integral of Moon and Spencer's
        # sky).
        for row, expected in zip(rows, (100, 39.62)):
            error = 100 * float(row["SE_v_lx"]) / 10000
            self.assertAlmostEqual(float(row["daylight_factor_percent"]), expected, delta=0.05 + 3 * error)
            self.assertLess(error, 0.2)

    def test_a_sensor_outside_sees_the_sky_that_no_patch_sees(self):
        rows = self.readings('up = "z"\n[[model]]\nfile = "room.obj"\n[sky]\nkind = "uniform"\nirradiance = 10\n'
                             '[[sensors]]\npoints = [[0, 0, 50, 0, 0, 1]]\n', "--sides", "front", "--patches", 100)
        # Nothing is above it.
        self.assertAlmostEqual(float(rows[0]["E_r"]), 10, delta=0.01 + 3 * float(rows[0]["SE_r"]))

    def test_a_lamp_beside_the_sky_leaves_no_daylight_factor(self):
        rows = self.readings('[[model]]\nfile = "ground.obj"\n[sky]\nkind = "overcast"\nilluminance = 10000\n'
                             '[[luminaire]]\nkind = "point"\nposition = [0, 0, 3]\nlumens = 1\n'
                             '[[sensors]]\npoints = [[0, 0, 1, 0, 0, 1]]\n', "--patches", 10)
        self.assertNotIn("daylight_factor_percent", rows[0])

    def test_sensors_are_written_beside_the_result_unless_told_otherwise(self):
        (self.folder / "results").mkdir()
        self.write("my.toml", '[[model]]\nfile = "room.obj"\n[[sensors]]\nname = "a"\npoints = [[0, 0, 1, 0, 0, 1]]\n')
        done = self.solve("my.toml", "--patches", 100, "-o", "results/out.vtp")
        self.assertEqual(len(self.rows("results/my.irradiance.csv")), 1)
        self.assertIn("U0", done.stdout)

    def test_doubtful_sensors_are_named_with_file_and_line(self):
        # The room with a closed box of 0.4 m in it.
        box = "".join(f"v {x} {y} {z}\n" for z in (0.2, 0.6) for y in (-0.2, 0.2) for x in (-0.9, -0.5))
        box += "".join(f"f {' '.join(map(str, face))}\n" for face in
                       ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (2, 4, 8, 6), (4, 3, 7, 8), (3, 1, 5, 7)))
        self.write("box.obj", box)
        self.write("spots.pts", "0 0 0.3 0 0 1\n-0.7 0 0.4 0 0 1\n-0.5 0 0.4 0 0 1\n")
        self.write("scene.toml", '[[model]]\nfile = "room.obj"\n[[model]]\nfile = "box.obj"\n')
        done = self.solve("scene.toml", "--patches", 200, "--points", "spots.pts")
        warnings = [line for line in done.stderr.splitlines() if "warning" in line]
        self.assertEqual(len(warnings), 2, done.stderr)
        self.assertIn("spots.pts:2", warnings[0])
        self.assertIn("inside a wall", warnings[0])
        self.assertIn("spots.pts:3", warnings[1])
        self.assertIn("in a surface", warnings[1])
        self.assertTrue(math.isnan(float(self.rows("spots.irradiance.csv")[1]["E_r"])))

    def test_pictures_are_taken_by_cameras_of_the_file(self):
        cameras = "".join(f'[[camera]]\nname = "{name}"\neye = [{x}, -0.5, 1]\ntarget = [0, 0.5, 0.5]\n'
                          for name, x in (("left", -0.8), ("right", 0.8)))
        self.write("scene.toml", '[[model]]\nfile = "room.obj"\n' + cameras)
        common = ("scene.toml", "--patches", 100, "-q", "--size", "80x60", "--picture")
        self.solve(*common, "first.png")
        self.solve(*common, "left.png", "--view", "left")
        self.solve(*common, "right.png", "--view", "right")
        pictures = [(self.folder / f"{name}.png").read_bytes() for name in ("first", "left", "right")]
        self.assertEqual(pictures[0], pictures[1])
        self.assertNotEqual(pictures[1], pictures[2])
        self.refused(INPUT, ["--view", "'top'", "left, right"], "solve", *common, "top.png", "--view", "top")

    def test_refusals(self):
        self.write("unknown.toml", '[[model]]\nfile = "room.obj"\nscales = 2\n')
        self.refused(INPUT, ["unknown.toml:3: ", "'scales'", " 'scale'?"], "solve", "unknown.toml", "-o",
                     "a.vtp")
        self.refused(INPUT, ["unknown.toml:3: "], "check", "unknown.toml")
        self.write("nothing.toml", 'unit = "m"\n')
        self.refused(INPUT, ["nothing.toml", "names no model"], "solve", "nothing.toml", "-o", "a.vtp")
        self.write("bad.toml", "[[model]\n")
        self.refused(INPUT, ["bad.toml:1: "], "solve", "bad.toml", "-o", "a.vtp")
        self.refused(INPUT, ["none.toml", "does not exist"], "solve", "none.toml", "-o", "a.vtp")
        self.write("plain.toml", '[[model]]\nfile = "room.obj"\n')
        self.refused(INPUT, ["--points-output", "no sensors"], "solve", "plain.toml", "--points-output", "a.csv")
        self.refused(INPUT, ["--unit"], "solve", "plain.toml", "--unit", "cm", "-o", "a.vtp")
        self.refused(USAGE, ["--points-output", ".csv or .vtp"], "solve", "plain.toml", "--points-output", "a.txt")
        self.refused(USAGE, ["--view", "--picture"], "solve", "plain.toml", "-o", "a.vtp", "--view", "a")
        self.assertEqual(sorted(p.name for p in self.folder.glob("a.*")), [])

    def test_lights_of_a_scene_are_not_lost_with_its_form_factors(self):
        self.write("lit.toml", '[[model]]\nfile = "room.obj"\n[[luminaire]]\nkind = "point"\nposition = [0, 0, 1.5]\n'
                   'lumens = 100\n[[sensors]]\npoints = [[0.5, 0.5, 0.3, 0, 0, 1]]\n')
        done = self.run_tool("form-factors", "lit.toml", "-o", "lit.ff", "--patches", 200, "--no-contact-lines", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.solve("lit.toml", "--form-factors", "lit.ff", "--points-output", "stored.csv", "-q")
        # Patches do not end at the edges of shadows here, as stored form factors do not depend on lights.
        self.solve("lit.toml", "--patches", 200, "--no-contact-lines", "--no-error-bars", "--points-output", "anew.csv",
                   "-q")
        done = self.run_tool("relight", "lit.ff", "--points-output", "relit.csv", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        anew = float(self.rows("anew.csv")[0]["E_v_lx"])
        # Stored form factors are rounded to floats: 6e-8.
        for name in ("stored.csv", "relit.csv"):
            self.assertAlmostEqual(float(self.rows(name)[0]["E_v_lx"]), anew, delta=1e-6 * anew)


if __name__ == "__main__":
    unittest.main()
