"""Commands that read a model have the same options for it, and decide about effects in the same way."""
import json
import unittest

from support import ToolTest

GOOD, USAGE = 0, 1
SCENE = '''[[model]]
file = "room.obj"
[[luminaire]]
kind = "point"
watts = 200
position = [0.5, 0.5, 1.5]
'''

DAY = '''[[model]]
file = "room.obj"
[[material]]
name = "*"
exitance = 0
[sky]
kind = "uniform"
illuminance = 10000
'''


class OptionsTest(ToolTest):
    def good(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, GOOD, (arguments, done.stdout, done.stderr))
        return done.stdout

    def refused(self, named, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, USAGE, (arguments, done.stderr))
        for word in named:
            self.assertIn(word, done.stderr)

    def test_lengths_take_units_and_shares_percent(self):
        def report(*words):
            self.good("solve", "room.obj", "--unit", "cm", "--json", "report.json", "-q", *words)
            return json.loads((self.folder / "report.json").read_text())

        bare = report("--max-edge", "40", "--set", "white.reflectance=0.3")
        stated = report("--max-edge", "4mm", "--set", "white.reflectance=30%")
        self.assertAlmostEqual(bare["request"]["max_edge_m"], 0.4, places=12)
        self.assertAlmostEqual(stated["request"]["max_edge_m"], 0.004, places=12)
        walls = [[m["reflectance"] for m in r["materials"] if m["name"] == "white"] for r in (bare, stated)]
        self.assertEqual(walls, [[[0.3] * 3]] * 2)

    def test_solvers_that_serve_rows_of_rays_leave_the_storage_open(self):
        # More than 10,000 patches, whose pairs would need gigabytes.
        for solver in ("gmres", "bicgstab"):
            self.good("solve", "room.obj", "--patches", "11000", "--solver", solver, "--json", "report.json", "-q")
            report = json.loads((self.folder / "report.json").read_text())
            self.assertEqual(report["plan"]["storage"], "rays", solver)
            self.assertEqual(report["plan"]["solver"], solver)

    def test_maintained_lamps_give_their_share(self):
        # The light is linear in the lamps, and there is no other light.
        def irradiances(*words, scene="scene.toml"):
            self.good("solve", scene, "--patches", "100", "--json", "report.json", "-q", *words)
            report = json.loads((self.folder / "report.json").read_text())
            return ([m["irradiance_mean_W_m2"][0] for m in report["materials"]], report["input"]["notes"])

        self.write("scene.toml", SCENE)
        new, _ = irradiances()
        for words in (["--maintenance-factor", "0.8"], ["--maintenance-factor", "80%"]):
            kept, notes = irradiances(*words)
            for a, b in zip(new, kept):
                self.assertAlmostEqual(b, 0.8 * a, delta=1e-5 * a)
            self.assertTrue("maintenance_factor" in [note["code"] for note in notes], notes)
        self.write("scene.toml", "maintenance_factor = 0.5\n" + SCENE)
        half, _ = irradiances()
        for a, b in zip(new, half):
            self.assertAlmostEqual(b, 0.5 * a, delta=1e-5 * a)
        # Daylight does not change with the age of lamps.
        self.write("day.toml", DAY)
        day, _ = irradiances(scene="day.toml")
        self.assertGreater(max(each for each in day if each is not None), 0)
        self.assertEqual(irradiances("--maintenance-factor", "0.5", scene="day.toml")[0], day)
        self.refused(["--maintenance-factor", "expected"], "solve", "scene.toml", "-o", "a.vtp", "--maintenance-factor",
                     "1.2")

    def test_all_that_read_a_model_take_the_same(self):
        model = ["--format", "--unit", "--set", "--up", "--confine", "--sides"]
        effects = ["--enable", "--disable"]
        for command, options in (("solve", model + effects), ("plan", model + effects), ("crosscheck", model + effects),
                                 ("compare-solvers", model + effects), ("convergence", model + effects),
                                 ("form-factors", model + effects), ("check", model),
                                 ("relight", ["--set", "--up"] + effects)):
            words = [line.split()[0] for line in self.good(command, "--help").splitlines() if line.startswith("  -")]
            for option in options:
                with self.subTest(command=command, option=option):
                    self.assertIn(option, words)

    def test_paths_leave_out_the_lights_that_are_skipped(self):
        """The luminaire emits far more than the bar, so the results would differ if only one side had it."""
        self.write("scene.toml", SCENE)
        means = []
        for skip in ((), ("--disable", "luminaires")):
            self.good("crosscheck", "scene.toml", "--patches", 400, "--paths", 1024, "--margin", "5%", "--json", "a.json", *skip)
            checked = json.loads((self.folder / "a.json").read_text())["checked"]
            means.append(sum(patch["traced_W_m2"][0] for patch in checked) / len(checked))
        self.assertGreater(means[0], 3 * means[1])

    def test_verify_needs_a_bar_where_errors_are_not_known(self):
        for words in (["--no-closure"], ["--disable", "interreflection"]):
            self.refused([" ".join(words), "--margin"], "crosscheck", "room.obj", *words)
        self.good("crosscheck", "room.obj", "--patches", 400, "--paths", 1024, "--no-closure", "--margin", "5%")
        # Paths simulate effects that the solution leaves out.
        done = self.run_tool("crosscheck", "room.obj", "--patches", 400, "--paths", 256, "--disable", "interreflection", "--margin", "2%")
        self.assertIn("DISAGREES", done.stdout)

    def test_form_factors_of_sides_that_are_forced(self):
        rows = {}
        for name, words in (("auto", ()), ("forced", ("--enable", "backs")), ("both", ("--sides", "both"))):
            self.good("form-factors", "room.obj", "--patches", 100, "-o", name, "-q", *words)
            sides = json.loads((self.folder / name / "scene.json").read_text())["kept_sides"]
            rows[name] = sum(sides["front"]) + sum(sides["back"])
        self.assertLess(rows["auto"], rows["forced"])
        self.assertLessEqual(rows["forced"], rows["both"])
        self.good("form-factors", "room.obj", "--patches", 100, "-o", "raw", "-q", "--no-closure")
        self.assertIsNone(json.loads((self.folder / "raw" / "info.json").read_text())["closure"])
        self.refused(["sun", "reach"], "form-factors", "room.obj", "-o", "F", "--disable", "sun")

    def test_relight_and_compare_decide_about_effects(self):
        self.good("form-factors", "room.obj", "--patches", 100, "-o", "F", "-q")
        radiosity = []
        for words in ((), ("--disable", "interreflection")):
            self.good("relight", "F", "-q", "--json", "a.json", *words)
            radiosity.append(json.loads((self.folder / "a.json").read_text())["energy_balance"]["absorbed_W"][0])
        self.assertGreater(radiosity[0], 1.1 * radiosity[1])
        self.refused(["occlusion", "luminaires"], "relight", "F", "-q", "-o", "a.ply", "--disable", "occlusion")
        self.good("compare-solvers", "room.obj", "--patches", 100, "-o", "C", "-q", "--solvers", "cg,progressive-on-demand",
                  "--no-series")
        self.refused(["interreflection"], "compare-solvers", "room.obj", "-o", "D", "--disable", "interreflection")
        self.refused(["--no-closure"], "convergence", "room.obj", "-o", "D", "--no-closure")

    def test_check_counts_the_sides_that_take_part(self):
        counts = {}
        for sides in ("auto", "front", "both"):
            facts = json.loads(self.good("check", "room.obj", "--sides", sides, "--json"))["sides"]
            self.assertEqual((facts["chosen"], facts["of"]), (sides, 16))
            counts[sides] = facts["take_part"]
            self.assertIn(f"sides ({sides}): {counts[sides]} of 16", self.good("check", "room.obj", "--sides", sides))
        # One side of the six walls and both sides of plate and lamp; front sides; all sides.
        self.assertEqual(counts, {"auto": 10, "front": 8, "both": 16})
        self.assertIsNone(json.loads(self.good("check", "room.obj", "--json"))["sides"])


if __name__ == "__main__":
    unittest.main()
