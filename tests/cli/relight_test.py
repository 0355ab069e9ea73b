"""patchlight relight: other lamps and materials with stored form factors, from their folder alone."""
import json
import re
import shutil
import struct
import unittest

from support import ROOM, ToolTest, content

GOOD, USAGE, INPUT, MEMORY, NOT_CONVERGED = 0, 1, 2, 4, 3

# Rounding changes a stored form factor by at most 5 * 2^-24 = 3e-7; the rest of a row's sum stays with the row. If all
# entries have this relative error with one sign, irradiance changes by 1 + rho / (1 - rho) times as much: 3e-7 * (1 +
# 0.7 / 0.3) = 1e-6. The solver's error of 1e-10 and the nine digits of the CSV are negligible.
FLOAT_STORAGE = 1e-6
EXACT = ["--tolerance", "1e-10"]

SHED = """v 5 0 0
v 6 0 0
v 6 1 0
v 5 1 0
v 5 0 1
v 6 0 1
v 6 1 1
v 5 1 1
usemtl shed
f 17 18 19 20
f 21 24 23 22
f 17 21 22 18
f 18 22 23 19
f 19 23 24 20
f 20 24 21 17
"""


class RelightTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("points.txt", "0 0 0.5 0 0 1\n-0.9 0.2 1 1 0 0\n0.3 0.4 1.5 0 0 -1\n0.7 -0.7 0.2 -1 1 0.5\n")

    def good(self, *words):
        done = self.run_tool(*words)
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)
        return done

    def find(self, *words, folder="room.ff"):
        self.good("form-factors", "room.obj", "-o", folder, "--patches", "200", *words)

    def report(self, name):
        return json.loads((self.folder / name).read_text())

    def irradiance(self, name):
        lines = (self.folder / name).read_text().splitlines()[1:]
        return [[float(word) for word in line.split(",")[6:9]] for line in lines]

    def expect_close(self, some, others, relative):
        self.assertEqual(len(some), len(others))
        for row, other in zip(some, others):
            self.assertEqual(len(row), len(other))
            for a, b in zip(row, other):
                self.assertAlmostEqual(a, b, delta=relative * abs(b))

    def leave_the_folder_alone(self):
        """Moves the folder and removes the model, so that relight has only the folder."""
        (self.folder / "elsewhere").mkdir()
        shutil.move(self.folder / "room.ff", self.folder / "elsewhere" / "moved.ff")
        for name in ("room.obj", "room.mtl"):
            (self.folder / name).unlink()
        return "elsewhere/moved.ff"

    def test_equals_a_solve_with_the_same_settings(self):
        cases = ([], ["--set", "white.reflectance=0.2,0.3,0.7"],
                 ["--set", "lamp.exitance=0", "--set", "white.radiance=1,2,3"])
        for k, settings in enumerate(cases):
            self.good("solve", "room.obj", "--patches", "200", "--no-error-bars", "--points", "points.txt", "--points-output",
                      f"fresh{k}.csv", "--json", f"fresh{k}.json", *EXACT, *settings)
        self.find()
        folder = self.leave_the_folder_alone()
        for k, settings in enumerate(cases):
            self.good("relight", folder, "--points", "points.txt", "--points-output", f"again{k}.csv", "--json",
                      f"again{k}.json", *EXACT, *settings)
            self.expect_close(self.irradiance(f"again{k}.csv"), self.irradiance(f"fresh{k}.csv"), FLOAT_STORAGE)
            fresh, again = self.report(f"fresh{k}.json"), self.report(f"again{k}.json")
            self.assertEqual(fresh["mesh"], again["mesh"])
            self.assertEqual(fresh["input"], again["input"])
            for key in ("emitted_W", "absorbed_W"):
                self.expect_close([again["energy_balance"][key]], [fresh["energy_balance"][key]], FLOAT_STORAGE)

    def test_a_lamp_that_lay_in_the_dark_is_noted(self):
        self.write("room.obj", ROOM + SHED)
        with (self.folder / "room.mtl").open("a") as file:
            file.write("newmtl shed\nKd 0.5 0.5 0.5\n")
        self.find()
        done = self.good("relight", "room.ff", "--json", "lit.json", "--set", "shed.exitance=1")
        # The shed's faces look inward, and there was no lamp.
        self.assertRegex(done.stderr, r"note: lost_light: .*'shed'")
        self.assertRegex(done.stderr, r"note: lost_light: .*\b[1-9][0-9]* sides?\b")
        # The patches stay those of the stored form factors.
        done = self.good("relight", "room.ff", "--json", "dark.json")
        self.assertNotIn("lost_light", done.stderr)
        self.assertEqual(self.report("lit.json")["mesh"], self.report("dark.json")["mesh"])

    def test_twice_the_light_is_twice_the_irradiance(self):
        self.find()
        for name, exitance in (("one", "10,9,8"), ("two", "20,18,16")):
            self.good("relight", "room.ff", "--json", f"{name}.json", "--set", f"lamp.exitance={exitance}")
        one, two = self.report("one.json"), self.report("two.json")
        # A factor of 2 changes no digit of a floating-point sum, and the solver stops at the same iteration.
        for key in ("irradiance_min_W_m2", "irradiance_mean_W_m2", "irradiance_max_W_m2"):
            for before, after in zip(one["materials"], two["materials"]):
                self.assertGreater(min(before[key]), 0)
                self.expect_close([after[key]], [[2 * value for value in before[key]]], 1e-12)

    def test_every_output_and_unit(self):
        self.write("mm.obj", re.sub(r"^v (.*)$", lambda v: "v " + " ".join(f"{1000 * float(x):.0f}" for x in v[1].split()),
                                    ROOM, flags=re.MULTILINE))
        self.write("mm.txt", "0 0 500 0 0 1\n")
        self.good("form-factors", "mm.obj", "--unit", "mm", "-o", "mm.ff", "--patches", "200")
        words = ["--points", "mm.txt", "--camera", "-900,0,1000", "900,0,1000", "60"]
        self.good("relight", "mm.ff", "-o", "a.vtp", "-o", "a.ply", "-o", "a.glb", "--series", "a.pvd", "--json", "a.json",
                  "--picture", "a.png", "--points-output", "a.csv", *words)
        self.good("solve", "mm.obj", "--unit", "mm", "--form-factors", "mm.ff", "--picture", "b.png", "--json", "b.json",
                  "--points-output", "b.csv", *words, "--solver", "jacobi")
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())
        self.assertEqual((self.folder / "a.csv").read_bytes(), (self.folder / "b.csv").read_bytes())
        self.assertEqual(self.report("a.json")["input"], self.report("b.json")["input"])
        for name in ("a.vtp", "a.ply", "a.glb", "a.pvd"):
            self.assertTrue((self.folder / name).exists())

    def test_names_of_any_bytes(self):
        name = b"stra\xdfe"
        for file in ("room.obj", "room.mtl"):
            path = self.folder / file
            path.write_bytes(path.read_bytes().replace(b"white", name))
        self.find()
        self.good("relight", "room.ff", "--json", "a.json", "--set",
                  name.decode(errors="surrogateescape") + ".reflectance=0.1")
        self.assertEqual(self.report("a.json")["input"]["materials"], 2)

    def test_without_closure_takes_raw_ones_alone(self):
        self.find()
        self.find("--no-closure", folder="raw.ff")
        self.assertEqual(self.run_tool("relight", "room.ff", "-o", "a.vtp", "--no-closure").returncode, INPUT)
        self.good("relight", "raw.ff", "--json", "a.json", "--no-closure")
        self.assertEqual(self.report("a.json")["transport"]["closure"], "none: not wanted")

    def test_a_model_without_a_lamp_is_lit_later(self):
        self.write("room.mtl", "newmtl white\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\n")
        self.find()
        done = self.run_tool("relight", "room.ff", "-o", "a.vtp")
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("--set lamp.radiance=10", done.stderr)
        self.good("relight", "room.ff", "-o", "a.vtp", "--set", "lamp.exitance=5")

    def test_same_bits_for_any_number_of_threads(self):
        self.find()
        bodies = set()
        for threads in ("1", "3"):
            self.good("relight", "room.ff", "-o", "a.ply", "--threads", threads)
            # The header has the command line.
            bodies.add((self.folder / "a.ply").read_bytes().split(b"end_header\n", 1)[1])
        self.assertEqual(len(bodies), 1)

    def test_errors_that_are_not_known_have_a_remedy(self):
        self.find()
        done = self.good("relight", "room.ff", "-o", "a.vtp")
        self.assertIn("\nhint: patchlight solve ", done.stdout)
        self.find("--method", "rays", folder="rays.ff")
        done = self.good("relight", "rays.ff", "--json", "a.json")
        self.assertIn(f" {100 * self.report('a.json')['transport']['ray_error']:.2g} %", done.stdout)
        self.assertIn("\nhint: patchlight solve ", done.stdout)

    def test_not_converged_is_said(self):
        self.find()
        done = self.run_tool("relight", "room.ff", "-o", "a.vtp", "--max-iterations", "1")
        self.assertEqual(done.returncode, NOT_CONVERGED)
        self.assertTrue((self.folder / "a.vtp").exists())

    def expect_refused(self, code, *words, says):
        before = content(self.folder)
        done = self.run_tool("relight", *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        for word in says:
            self.assertIn(word, done.stderr)
        self.assertEqual(content(self.folder), before)

    def test_refusals(self):
        self.find()
        to = ["-o", "a.vtp"]
        self.expect_refused(USAGE, says=["FOLDER"])
        self.expect_refused(USAGE, "room.ff", says=["-o, --html, --series"])
        self.expect_refused(USAGE, "room.ff", *to, "--patches", "9", says=["unknown option --patches"])
        self.expect_refused(USAGE, "room.ff", "-o", "room.ff/a.vtp", says=["-o: 'room.ff/a.vtp' "])
        self.expect_refused(USAGE, "room.ff", "-o", "room.ff/mesh.vtp", says=["-o: 'room.ff/mesh.vtp' "])
        self.expect_refused(INPUT, "missing.ff", *to, says=["missing.ff", "no info.json"])
        self.expect_refused(INPUT, "room.obj", *to, says=["room.obj: ", "patchlight form-factors"])
        self.expect_refused(INPUT, "room.ff", *to, "--set", "glass.exitance=1", says=["'glass'", "white, lamp"])
        self.expect_refused(USAGE, "room.ff", *to, "--set", "lamp.exitance=-1", says=["--set", "negative"])
        self.expect_refused(INPUT, "room.ff", *to, "--set", "lamp.exitance=0", says=["no light source"])
        self.expect_refused(MEMORY, "room.ff", *to, "--memory", "1MB", says=["need about"])

    def test_damaged_folders(self):
        self.find()
        to = ["-o", "a.vtp"]
        scene = self.folder / "room.ff/scene.json"
        text = scene.read_text()
        scene.unlink()
        self.expect_refused(INPUT, "room.ff", *to, says=["scene.json"])
        scene.write_text(text[:-100])
        self.expect_refused(INPUT, "room.ff", *to, says=["room.ff/scene.json: "])
        moved = json.loads(text)
        moved["vertices"][0] += 1e-9
        scene.write_text(json.dumps(moved))
        self.expect_refused(INPUT, "room.ff", *to, says=["room.ff: ", "patchlight form-factors MODEL -o room.ff"])
        scene.write_text(text)

        F = self.folder / "room.ff/F.npy"
        data = F.read_bytes()
        size = json.loads((self.folder / "room.ff/info.json").read_text())["patches"]
        for entry, value in ((1, float("nan")), (size, -1.0), (size * size - 2, 0.5), (70 * size + 3, 0.5)):
            place = len(data) - 4 * (size * size - entry)
            F.write_bytes(data[:place] + struct.pack("<f", value) + data[place + 4 :])
            self.expect_refused(INPUT, "room.ff", *to, says=["F.npy", "found a form factor"])
        F.write_bytes(data[:-4])
        self.expect_refused(INPUT, "room.ff", *to, says=["F.npy"])
        F.write_bytes(data)
        self.good("relight", "room.ff", *to)


    def test_rows_of_rays_take_any_light(self):
        """B is linear in E: a lamp of twice the exitance gives twice the light, to the written digits."""
        self.find("--method", "rays", folder="rays.ff")
        for name, words in (("once", ["--set", "lamp.radiance=10"]), ("twice", ["--set", "lamp.radiance=20"])):
            self.good("relight", "rays.ff", *words, "--json", name + ".json", "-o", name + ".vtp")
        once, twice = self.report("once.json"), self.report("twice.json")
        self.assertFalse(once["transport"]["shadow_rays"])
        for a, b in zip(once["energy_balance"]["absorbed_W"], twice["energy_balance"]["absorbed_W"]):
            self.assertAlmostEqual(b / a, 2, delta=1e-9)
        refused = self.run_tool("solve", "room.obj", "--form-factors", "rays.ff", "--error-bars", "-o", "x.vtp")
        self.assertEqual(refused.returncode, USAGE, refused.stderr)
        self.assertIn("--error-bars", refused.stderr)
        refused = self.run_tool("relight", "rays.ff", "--solver", "cg", "-o", "x.vtp")
        self.assertEqual(refused.returncode, INPUT, refused.stderr)
        self.assertIn("--solver cg", refused.stderr)

    def test_keeps_luminaires_sun_and_sky(self):
        """Light from sources other than faces is recomputed; another sky replaces the stored one."""
        lights = """[[luminaire]]
kind = "point"
position = [0.2, 0.1, 1.5]
lumens = 500
[sky]
kind = "overcast"
illuminance = %d
[[sensors]]
name = "desk"
points = [[0.1, 0.2, 0.5, 0, 0, 1]]
"""
        # Patches of stored form factors do not follow the shadows of luminaires.
        mesh = ["--sides", "both", "--patches", "200", "--no-contact-lines"]
        for name, lux in (("day", 10000), ("dull", 5000)):
            self.write(name + ".toml", '[[model]]\nfile = "room.obj"\n' + lights % lux)
            self.good("solve", name + ".toml", *mesh, "--no-error-bars", "-o", name + ".vtp", "--json",
                      name + ".json", *EXACT)
        self.good("form-factors", "day.toml", *mesh, "-o", "day.ff")
        self.good("relight", "day.ff", "-o", "again.vtp", "--json", "again.json", *EXACT)
        self.good("relight", "day.ff", "--sky", "overcast:5000lx", "--ground", "0", "-o", "less.vtp", "--json", "less.json", *EXACT)
        for fresh, again in (("day", "again"), ("dull", "less")):
            for key in ("arriving_W", "absorbed_W"):
                for a, b in zip(self.report(fresh + ".json")["energy_balance"][key],
                                self.report(again + ".json")["energy_balance"][key]):
                    self.assertAlmostEqual(a, b, delta=FLOAT_STORAGE * abs(a))
        self.assertNotEqual(self.report("day.json")["energy_balance"]["arriving_W"],
                            self.report("dull.json")["energy_balance"]["arriving_W"])
        self.assertEqual(self.report("again.json")["sensors"]["groups"][0]["name"], "desk")

    def test_colours_of_panes_and_mirrors(self):
        """Rows traced with a gray pane and mirror equal those traced with colored ones."""
        self.write("panes.obj", """mtllib panes.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -1 -1 2
v 1 -1 2
v 1 1 2
v -1 1 2
v 0 -1 0
v 0 1 0
v 0 1 2
v 0 -1 2
usemtl wall
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 4 3 7 8
f 2 6 7 3
usemtl mirror
f 1 4 8 5
usemtl pane
f 9 10 11 12
""")
        self.write("panes.mtl", "newmtl wall\nKd 0.6 0.6 0.6\nKe 1 1 1\nnewmtl mirror\nKd 0 0 0\nKs 0.8 0.8 0.8\n"
                   "illum 3\nnewmtl pane\nKd 0 0 0\nd 0.5\nTf 0.8 0.8 0.8\n")
        self.good("form-factors", "panes.obj", "--method", "rays", "--patches", "200", "-o", "panes.ff")
        info = json.loads((self.folder / "panes.ff" / "info.json").read_text())
        self.assertTrue(info["specular"])
        self.assertIn("pane", info["classes"])
        self.assertIn("mirror mirrored", info["classes"])
        colours = ["--set", "pane.transmittance=0.8,0.1,0.05", "--set", "mirror.specular_reflectance=0.9,0.7,0.3"]
        self.good("relight", "panes.ff", *colours, "--json", "again.json", "-o", "again.vtp")
        self.good("form-factors", "panes.obj", "--method", "rays", "--patches", "200", *colours, "-o", "red.ff")
        self.good("relight", "red.ff", "--json", "fresh.json", "-o", "fresh.vtp")
        again, fresh = self.report("again.json"), self.report("fresh.json")
        for a, b in zip(again["energy_balance"]["absorbed_W"], fresh["energy_balance"]["absorbed_W"]):
            self.assertAlmostEqual(a / b, 1, delta=1e-9)
        refused = self.run_tool("relight", "panes.ff", "--set", "pane.index=1.7", "-o", "x.vtp")
        self.assertEqual(refused.returncode, INPUT, refused.stderr)
        self.assertIn("glazing or mirrors", refused.stderr)


if __name__ == "__main__":
    unittest.main()
