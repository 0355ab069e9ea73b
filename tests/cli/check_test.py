"""patchlight check: the contents of a model, its faults, and whether it can be solved."""
import json
import math
import unittest

from support import MATERIALS, ROOM, ToolTest, content, run

GOOD, USAGE, INPUT, OUTPUT = 0, 1, 2, 6


class CheckTest(ToolTest):
    def check(self, *arguments, code=GOOD):
        done = self.run_tool("check", *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def report(self, *arguments, code=GOOD):
        return json.loads(self.check("--json", *arguments, code=code).stdout)

    def test_sound_room(self):
        before = content(self.folder)
        done = self.check("room.obj")
        for words in ("can be solved", "2 x 2 x 2 m", "lamp  flux 7.854", "0 errors, 0 warnings, 0 remarks", "1 closed"):
            self.assertIn(words, done.stdout)
        self.assertEqual(done.stderr, "")
        self.assertEqual(content(self.folder), before, "nothing is written")
        report = self.report("room.obj")
        self.assertTrue(report["usable"])
        self.assertEqual((report["polygons"], report["lamps"], report["closed_shells"]), (8, 1, 1))
        self.assertEqual(report["problems"], [])

    def test_json_goes_to_a_file_or_to_standard_output(self):
        done = self.check("room.obj", "--json", "check.json")
        self.assertIn("can be solved", done.stdout)
        text = (self.folder / "check.json").read_text()
        self.assertEqual(self.check("room.obj", "--json").stdout, text)
        self.assertEqual(self.check("--json", "room.obj").stdout, text)

    def test_problems_come_worst_first_with_their_lines(self):
        self.write("room.obj", ROOM + "usemtl brass\nf 1 2 2\nf 13 14 15 16\nf 16 15 14 13\nf 1 2 7 3\n")
        report = self.report("room.obj")
        kinds = [problem["kind"] for problem in report["problems"]]
        self.assertEqual(kinds[0], "unknown_material")
        self.assertIn("zero_area", kinds)
        severities = [("error", "warning", "remark").index(problem["severity"]) for problem in report["problems"]]
        self.assertEqual(severities, sorted(severities))
        line = ROOM.count("\n") + 2
        duplicate = next(problem for problem in report["problems"] if problem["kind"] == "duplicate_faces")
        self.assertEqual(duplicate["faces"], [{"file": "room.obj", "line": line + 1}])
        self.assertIn(f"room.obj:{line + 1}", duplicate["what"])

    def test_marked_faces_for_paraview(self):
        self.write("room.obj", ROOM + "f 1 2 2\n")
        self.check("room.obj", "--problems", "problems.vtp")
        data = (self.folder / "problems.vtp").read_bytes()
        for name in (b"problem_kind", b"severity", b"source_line", b"problem_names"):
            self.assertIn(name, data)

    def test_without_a_lamp_it_names_the_setting_that_switches_one_on(self):
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ka 20 10 5"))
        done = self.check("room.obj")
        setting = "--set lamp.radiance=20,10,5"
        self.assertIn(setting, done.stdout)
        self.assertIn(setting, done.stderr)
        self.assertFalse(self.report("room.obj")["usable"])
        self.check("room.obj", *setting.split())
        solved = self.run_tool("solve", "room.obj", "-o", "room.vtp", "--patches", "50")
        self.assertEqual(solved.returncode, INPUT)
        self.assertIn(setting, solved.stderr)

    def next_of(self, done):
        line = next(line for line in done.stdout.splitlines() if line.startswith("next: patchlight "))
        return line.removeprefix("next: patchlight ").split()

    def test_a_closed_room_without_a_lamp_is_not_offered_a_sky(self):
        """The suggested commands light the room: the next command and the one after it."""
        dark = MATERIALS.replace("Ke 10 9 8\n", "")
        self.write("room.mtl", dark)
        done = self.check("room.obj")
        self.assertNotIn("--sky", done.stdout + done.stderr)
        self.assertIn("(room.obj:19)", done.stderr)
        words = self.next_of(done)
        self.assertEqual(words, "solve room.obj --set lamp.radiance=10 -o room.vtp --picture room.png".split())

        self.write("room.mtl", dark.replace("lamp", "panel"))
        self.write("room.obj", ROOM.replace("usemtl lamp", "usemtl panel"))
        words = self.next_of(self.check("room.obj"))
        self.assertEqual(words, "init room.obj -o room.toml".split())
        self.assertEqual(self.run_tool(*words).returncode, GOOD)
        text = (self.folder / "room.toml").read_text()
        self.assertIn("[[luminaire]]\n", text)
        self.assertIn("\n# [sky]\n", text)
        solved = self.run_tool("solve", "room.toml", "--patches", 100, "-q", "--json", "a.json")
        self.assertEqual(solved.returncode, GOOD, solved.stderr)
        walls = json.loads((self.folder / "a.json").read_text())["materials"]
        self.assertGreater(next(m for m in walls if m["name"] == "white")["irradiance_mean_W_m2"][0], 0)

    def test_an_open_room_without_a_lamp_is_offered_a_sky(self):
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8\n", ""))
        self.write("room.obj", ROOM.replace("f 4 8 5 1\n", ""))
        done = self.check("room.obj")
        self.assertIn("--sky overcast:10000lx", done.stderr)
        self.assertIn("--sky", self.next_of(done))

    def test_reflectance_one_warns_and_an_open_room_is_solved(self):
        self.write("room.mtl", MATERIALS.replace("Kd 0.7 0.6 0.5", "Kd 1 1 1"))
        self.assertEqual([p["kind"] for p in self.report("room.obj")["problems"]], ["full_reflectance"])
        self.write("room.obj", ROOM.replace("f 4 8 5 1\n", ""))
        done = self.run_tool("solve", "room.obj", "-o", "room.vtp", "--patches", "100")
        self.assertEqual(done.returncode, GOOD, done.stderr)

    def test_unit_of_a_model_of_implausible_size(self):
        vertices = [line.split() for line in ROOM.splitlines()]
        scaled = [["v", *(str(1000 * float(x)) for x in words[1:])] if words[0] == "v" else words for words in vertices]
        self.write("room.obj", "\n".join(" ".join(words) for words in scaled) + "\n")
        report = self.report("room.obj")
        self.assertEqual(report["unit_guess"], "mm")
        self.assertEqual([p["kind"] for p in report["problems"]], ["implausible_size"])
        self.assertEqual(self.report("room.obj", "--unit", "mm")["problems"], [])
        solve = ("solve", "room.obj", "-o", "a.ply", "--patches", "60")
        self.assertRegex(self.run_tool(*solve).stderr, r"warning: implausible_size: .*\bmm\b")
        self.assertNotIn("implausible_size", self.run_tool(*solve, "--unit", "mm").stderr)

    def test_unusable_models_are_refused(self):
        self.write("room.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
        self.assertIn("room.obj:4", self.check("room.obj", code=INPUT).stderr)
        self.assertIn("missing.obj", self.check("missing.obj", code=INPUT).stderr)

    def test_several_files_and_standard_input(self):
        room, lamp = ROOM.split("usemtl lamp\n")
        vertices = [line for line in ROOM.splitlines() if line.startswith(("v ", "mtllib"))]
        self.write("walls.obj", room)
        self.write("lamp.obj", "\n".join(vertices) + "\nusemtl lamp\n" + lamp)
        whole, parts = self.report("room.obj"), self.report("walls.obj", "lamp.obj")
        for fact in ("polygons", "lamps", "closed_shells", "materials", "problems"):
            self.assertEqual(parts[fact], whole[fact])
        piped = run("check", "-", "--json", folder=self.folder, text=ROOM)
        self.assertEqual(json.loads(piped.stdout)["polygons"], whole["polygons"])

    def test_panes_are_listed_with_transmittance_and_index(self):
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ke 10 9 8\nd 0.2\nTf 1 0.5 1\nNi 1.45"))
        done = self.check("room.obj")
        self.assertIn("; transmittance 0.8, 0.4, 0.8, index 1.45; ", done.stdout)
        self.assertRegex(done.stdout, r"read_as_pane: .*\blamp\b.* 0\.8, 0\.4, 0\.8\b")
        materials = {material["name"]: material for material in self.report("room.obj")["materials"]}
        self.assertEqual((materials["lamp"]["transmittance"], materials["lamp"]["index"]), ([0.8, 0.4, 0.8], 1.45))
        opaque = self.check("room.obj", "--set", "lamp.transmittance=0").stdout
        self.assertNotIn("transmittance", opaque)
        for material in self.report("room.obj", "--set", "lamp.transmittance=0")["materials"]:
            self.assertEqual((material["transmittance"], material["index"]), (None, None))

    def test_mirrors_are_listed_with_their_specular_reflectance(self):
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ke 10 9 8\nKs 0.9 0.8 0.7\nillum 3"))
        done = self.check("room.obj")
        self.assertIn("; specular reflectance 0.9, 0.8, 0.7; ", done.stdout)
        self.assertRegex(done.stdout, r"read_as_mirror: .*\blamp\b.* 0\.9, 0\.8, 0\.7\b.* --set lamp\.specular_reflectance=0 ")
        found = {material["name"]: material["specular_reflectance"] for material in self.report("room.obj")["materials"]}
        self.assertEqual(found.pop("lamp"), [0.9, 0.8, 0.7])
        self.assertEqual(set(found.values()), {None})
        matt = self.check("room.obj", "--set", "lamp.specular_reflectance=0").stdout
        self.assertNotIn("specular", matt)

    def test_sun_sky_and_ground_are_listed(self):
        self.assertNotIn("sky", self.check("room.obj").stdout)
        report = self.report("room.obj")
        self.assertEqual((report["sun"], report["sky"]), (None, None))
        self.write("room.toml", 'up = "z"\n[[model]]\nfile = "room.obj"\n[sun]\ndirection = [0, 0, 1]\n'
                                'irradiance = 300\n[sky]\nkind = "overcast"\nirradiance = 100\n'
                                "[ground]\nreflectance = 0.5\n")
        done = self.check("room.toml")
        for line in ("sun: 300, 300, 300 W/m^2 direct normal, from (0, 0, 1)",
                     "sky: overcast, 100, 100, 100 W/m^2 horizontal, under the open sky", "ground: 63.66, 63.66, 63.66 W/(m^2 sr)"):
            self.assertIn(line + "\n", done.stdout)
        report = self.report("room.toml")
        self.assertEqual(report["sun"], {"direction": [0, 0, 1], "normal_irradiance_W_m2": [300] * 3})
        self.assertEqual((report["sky"]["kind"], report["sky"]["horizontal_irradiance_W_m2"]), ("overcast", [100] * 3))
        self.assertAlmostEqual(report["sky"]["ground_radiance_W_m2_sr"][0], 0.5 / math.pi * 400, places=9)

    def test_command_line(self):
        for arguments, word in (((), "model"), (("room.obj", "--problems", "a.vtk"), ".vtp"), (("room.obj", "--jsn"), "--json"),
                                (("room.obj", "--unit", "mile"), "--unit"), (("room.obj", "--json", "room.obj"), "room.obj")):
            with self.subTest(arguments):
                self.assertIn(word, self.check(*arguments, code=USAGE).stderr)
        self.assertIn("no/a.vtp", self.check("room.obj", "--problems", "no/a.vtp", code=OUTPUT).stderr)
        self.assertIn("problem_kind", self.check("--help").stdout)


if __name__ == "__main__":
    unittest.main()
