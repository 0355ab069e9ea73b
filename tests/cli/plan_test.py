"""patchlight plan: simulated effects, their reasons and costs; --enable and --disable, and their mention in results."""
import json
import math
import unittest

from support import MATERIALS, ROOM, ToolTest, content, is_one_message

GOOD, USAGE, INPUT = 0, 1, 2

EFFECTS = ["occlusion", "interreflection", "color", "reach", "backs", "luminaires", "sun", "sky", "textures", "mirrors",
           "closure"]


class PlanTest(ToolTest):
    def plan(self, *arguments):
        """The plan of room.obj as JSON, with its decisions by effect."""
        done = self.run_tool("plan", "room.obj", "--json", "plan.json", *arguments)
        self.assertEqual(done.returncode, GOOD, done.stderr)
        plan = json.loads((self.folder / "plan.json").read_text())
        plan["by_effect"] = {decision["effect"]: decision for decision in plan["decisions"]}
        return plan

    def assert_refused(self, words, *arguments):
        before = content(self.folder)
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, USAGE, done.stderr)
        self.assertTrue(is_one_message(done.stderr), done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertEqual(content(self.folder), before)

    def test_tells_every_effect_with_its_fact_and_the_cost(self):
        before = content(self.folder)
        done = self.run_tool("plan", "room.obj", "--patches", "1000")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        for effect in EFFECTS:
            self.assertIn(f"\n{effect}", done.stdout)
        self.assertEqual(content(self.folder), before, "nothing is written, nothing is solved")
        expected = self.plan("--patches", "1000")["expected"]
        self.assertIn(f" {expected['patches']} patches", done.stdout)
        self.assertIn(f" {expected['threads']} thread", done.stdout)

    def test_with_an_accuracy_it_tells_the_first_mesh(self):
        self.assertFalse(self.plan("--patches", "1000")["expected"]["of_first_mesh"])
        done = self.run_tool("plan", "room.obj", "--patches", "1000", "--accuracy", "1%", "--json", "plan.json")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        expected = json.loads((self.folder / "plan.json").read_text())["expected"]
        self.assertTrue(expected["of_first_mesh"])
        self.assertLess(abs(expected["patches"] - 1000), 200)

    def test_tells_what_sensors_take(self):
        self.write("sensors.toml", '[[model]]\nfile = "room.obj"\n[[sensors]]\nname = "plane"\ncorner = [0.1, 0.1, 0.8]\n'
                                   'edges = [[0.8, 0, 0], [0, 0.8, 0]]\nspacing = 0.02\n')
        options = ("plan", "sensors.toml", "--patches", "1000", "--json", "plan.json")
        done = self.run_tool(*options)
        self.assertEqual(done.returncode, GOOD, done.stderr)
        self.assertIn(" 1600 sensors", done.stdout)
        expected = json.loads((self.folder / "plan.json").read_text())["expected"]
        self.assertEqual(expected["sensors"], 1600)
        self.assertGreater(expected["sensor_cpu_seconds"], 1)
        self.assertNotIn("--time-limit", done.stdout)
        done = self.run_tool(*options, "--time-limit", "60s")
        self.assertIn("--time-limit", done.stdout)

    def test_a_second_mesh_that_does_not_fit_is_noted(self):
        options = ("plan", "room.obj", "--method", "rays", "--patches", "30000", "--json", "plan.json")
        done = self.run_tool(*options)
        self.assertIn("a second mesh", done.stdout)
        self.assertNotIn("second_mesh", done.stderr)
        needed = json.loads((self.folder / "plan.json").read_text())["expected"]["memory_bytes"]
        done = self.run_tool(*options, "--memory", f"{math.ceil(needed / 1e6) + 1}MB")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        self.assertIn("note: second_mesh: ", done.stderr)
        self.assertIn("(--memory)", done.stderr)
        self.assertNotIn("a second mesh", done.stdout)
        self.assertEqual(json.loads((self.folder / "plan.json").read_text())["notes"][-1]["code"], "second_mesh")

    def test_facts_decide(self):
        plan = self.plan("--patches", "1000")
        self.assertEqual(list(plan["by_effect"]), EFFECTS)
        on = {effect for effect, decision in plan["by_effect"].items() if decision["simulate"]}
        # The walls are not gray. All lamps are inside, so the outer sides are dark. There are no other lights.
        self.assertEqual(on, {"occlusion", "interreflection", "color", "reach", "closure"})
        self.assertLess(abs(plan["expected"]["patches"] - 1000), 100)
        self.assertGreater(plan["expected"]["seconds"], 0)
        black = self.plan("--set", "white.reflectance=0,0,0")["by_effect"]
        self.assertFalse(black["interreflection"]["simulate"])
        self.assertFalse(black["closure"]["simulate"])

    def test_what_is_not_simulated_is_named(self):
        self.write("room.mtl", MATERIALS.replace("Kd 0.7 0.6 0.5", "Kd 0.7 0.6 0.5\nKs 0.1 0.1 0.1\nmap_d holes.png"))
        plan = self.plan()["by_effect"]
        self.assertIn("1 material", plan["gloss"]["reason"])
        self.assertIn("1 transparent material", plan["glass"]["reason"])
        self.assertFalse(plan["gloss"]["simulate"])

    def test_mirrors_of_the_file_are_no_gloss(self):
        self.write("room.mtl", MATERIALS.replace("Kd 0.7 0.6 0.5", "Kd 0.1 0.1 0.1\nKs 0.9 0.8 0.7\nillum 3"))
        plan = self.plan()["by_effect"]
        self.assertTrue(plan["mirrors"]["simulate"])
        self.assertNotIn("gloss", plan)
        matt = self.plan("--set", "*.specular_reflectance=0")["by_effect"]
        self.assertFalse(matt["mirrors"]["simulate"])

    def test_results_say_what_was_overruled(self):
        done = self.run_tool("solve", "room.obj", "--patches", "200", "--disable", "occlusion", "--json", "report.json")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        self.assertIn("by option: occlusion", done.stdout)
        report = json.loads((self.folder / "report.json").read_text())
        self.assertEqual(report["request"]["skip"], ["occlusion"])
        decision = report["plan"]["decisions"][0]
        self.assertEqual((decision["effect"], decision["simulate"], decision["forced"]), ("occlusion", False, True))

    def test_closed_form_factors_stay_closed(self):
        black = ("--set", "white.reflectance=0,0,0")
        done = self.run_tool("form-factors", "room.obj", "--patches", "200", "-o", "room.ff")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        done = self.run_tool("solve", "room.obj", "--form-factors", "room.ff", *black, "--json", "report.json")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        decisions = json.loads((self.folder / "report.json").read_text())["plan"]["decisions"]
        by_effect = {decision["effect"]: decision for decision in decisions}
        self.assertFalse(by_effect["interreflection"]["simulate"])
        self.assertTrue(by_effect["closure"]["simulate"], "the rows of the folder are closed")
        done = self.run_tool("solve", "room.obj", "--form-factors", "room.ff", "--no-closure", "--json", "r.json")
        self.assertEqual(done.returncode, INPUT, done.stderr)
        self.assertIn("without closure", done.stderr)

    def test_an_empty_room_takes_no_shadow_rays_unless_forced(self):
        empty = ROOM.replace("f 13 14 15 16\n", "").replace("usemtl lamp\nf 9 12 11 10\n", "usemtl lamp\nf 5 8 7 6\n")
        self.write("room.obj", empty.replace("f 5 8 7 6\nf 1 5 6 2", "f 1 5 6 2"))
        rays = {}
        for name, options in {"planned": [], "forced": ["--enable", "occlusion"]}.items():
            done = self.run_tool("solve", "room.obj", "--patches", "200", "--json", "report.json", *options)
            self.assertEqual(done.returncode, GOOD, done.stderr)
            rays[name] = json.loads((self.folder / "report.json").read_text())["transport"]["shadow_rays"]
        self.assertEqual(rays["planned"], 0)
        self.assertGreater(rays["forced"], 0)

    def test_the_storage_of_form_factors_is_that_of_the_run(self):
        for asked, storage, solver in (((), "tiles", "cg"), (("--method", "rays"), "rays", "gmres"),
                                       (("--method", "on-demand"), "on-demand", "progressive"),
                                       (("--patches", 12000), "rays", "gmres")):
            plan = self.plan(*asked)
            self.assertEqual((plan["storage"], plan["solver"]), (storage, solver), asked)
            if "--patches" in asked:
                continue
            done = self.run_tool("solve", "room.obj", "--patches", 300, *asked, "-o", "a.vtp", "--json", "a.json")
            self.assertEqual(done.returncode, GOOD, done.stderr)
            report = json.loads((self.folder / "a.json").read_text())
            self.assertEqual((report["plan"]["storage"], report["plan"]["solver"]), (storage, solver))

    def test_contradictions_are_refused(self):
        outputs = ("solve", "room.obj", "-o", "room.vtp")
        self.assert_refused(["--enable sun", "--disable sun"], *outputs, "--enable", "sun", "--disable", "sun")
        self.assert_refused(["--no-closure", "--method on-demand"], *outputs, "--no-closure", "--method", "on-demand", "--solver",
                            "progressive")
        self.assert_refused(["--disable reach", "--sides"], *outputs, "--disable", "reach", "--sides", "both")
        self.assert_refused(["--disable interreflection", "--accuracy"], *outputs, "--disable", "interreflection", "--accuracy",
                            "1%")
        self.assert_refused(["--no-closure", "--error-bars"], *outputs, "--no-closure", "--error-bars")
        self.assert_refused(["--enable occlusion", "--form-factors"], *outputs, "--enable", "occlusion", "--form-factors",
                            "room.ff")
        self.assert_refused(["shadows", "occlusion"], *outputs, "--disable", "shadows")
        self.assert_refused(["--disable", "gloss"], *outputs, "--disable", "gloss")

    def test_skipping_all_light_is_refused(self):
        self.write("sky.toml", '[[model]]\nfile = "room.obj"\n[sky]\nkind = "uniform"\nirradiance = 10\n')
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ke 0 0 0"))
        done = self.run_tool("solve", "sky.toml", "--patches", "100", "--disable", "sky", "-o", "room.vtp")
        self.assertEqual(done.returncode, INPUT, done.stderr)
        self.assertIn("disabled: sky", done.stderr)


if __name__ == "__main__":
    unittest.main()
