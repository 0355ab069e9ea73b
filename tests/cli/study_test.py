"""patchlight convergence: the cost of accuracy."""
import csv
import json
import unittest

from support import ToolTest, content, is_one_message

GOOD, USAGE, NOT_CONVERGED, MEMORY, OUTPUT = 0, 1, 3, 4, 6
PLOTS = ["display_error_by_cpu_second", "error_by_cpu_second", "error_by_memory", "estimators_by_cpu_second"]
FILES = sorted([f"{name}.{kind}" for name in PLOTS for kind in ("png", "svg")] + ["study.csv", "study.json"])
COLUMNS = ["sweep", "patches", "estimator", "samples", "tolerance", "seconds", "cpu_seconds", "plan_seconds",
           "mesh_seconds", "form_factors_seconds", "closure_seconds", "solve_seconds", "error_bars_seconds",
           "plan_cpu_seconds", "mesh_cpu_seconds", "form_factors_cpu_seconds", "closure_cpu_seconds",
           "solve_cpu_seconds", "error_bars_cpu_seconds", "matrix_bytes", "error", "display_error",
           "own_error", "order", "on_time_front", "on_memory_front"]


class StudyTest(ToolTest):
    def study(self, patches, *words):
        done = self.run_tool("convergence", "room.obj", "--patches", patches, "-o", "out", "--no-adaptive", *words)
        self.assertEqual(done.returncode, GOOD, done.stderr)
        with (self.folder / "out" / "study.csv").open(newline="") as lines:
            rows = list(csv.DictReader(lines))
        return done, rows, json.loads((self.folder / "out" / "study.json").read_text())

    def test_folder_and_table(self):
        done, rows, facts = self.study(300)
        self.check_table(done, rows, facts)
        self.check_errors(rows, facts)

    def check_table(self, done, rows, facts):
        self.assertEqual(sorted(path.name for path in (self.folder / "out").iterdir()), FILES)
        self.assertEqual(list(rows[0]), COLUMNS)
        sweeps = {row["sweep"] for row in rows}
        self.assertEqual(sweeps, {"patch size at 8 samples", "patch size at 32 samples", "samples", "tolerance"} |
                         {f"estimator {name}" for name in ("auto", "area", "point-polygon", "hemisphere", "contour")})
        self.assertEqual(len(rows), len(facts["settings"]))
        for row, setting in zip(rows, facts["settings"]):
            for key in ("patches", "samples", "cpu_seconds", "error", "own_error"):
                self.assertAlmostEqual(float(row[key]), setting[key], delta=1e-8 * abs(setting[key]))
            stages = sum(float(row[key]) for key in COLUMNS if key.endswith("_cpu_seconds"))
            self.assertAlmostEqual(stages, float(row["cpu_seconds"]), delta=1e-6)
        # The last line but one is the conclusion.
        self.assertEqual(done.stdout.splitlines()[-2], facts["conclusion"])
        self.assertGreater(len(facts["conclusion"]), 0)

    def check_errors(self, rows, facts):
        """Errors fall as the number of patches grows."""
        fine = [row for row in rows if row["sweep"] == "patch size at 32 samples"]
        self.assertGreater(len(fine), 1)
        for before, after in zip(fine, fine[1:]):
            self.assertGreater(float(before["display_error"]), float(after["display_error"]))
        self.assertGreater(facts["reference"]["patches"], 3 * int(fine[-1]["patches"]))
        self.assertFalse(facts["reference"]["closed_form"])
        self.assertGreater(facts["reference"]["bar"], 0)

    def test_an_earlier_result_is_replaced_and_nothing_else(self):
        self.study(100, "--no-estimators")
        self.study(100, "--no-estimators", "--sizes", 2)
        (self.folder / "out" / "thesis.tex").write_text("mine")
        before = content(self.folder)
        done = self.run_tool("convergence", "room.obj", "--patches", 100, "-o", "out")
        self.assertEqual(done.returncode, OUTPUT)
        self.assertEqual(content(self.folder), before)

    def test_refusals(self):
        for words in (["--sizes", "1"], ["--tolerance", "1"], ["--estimator", "area"], ["--patches", "0"]):
            done = self.run_tool("convergence", "room.obj", "-o", "out", *words)
            self.assertEqual(done.returncode, USAGE, words)
            self.assertTrue(is_one_message(done.stderr), done.stderr)
            self.assertIn(words[0], done.stderr)
        self.assertEqual(self.run_tool("convergence", "room.obj").returncode, USAGE)

    def test_a_reference_that_does_not_fit_is_refused(self):
        done = self.run_tool("convergence", "room.obj", "--patches", 4000, "--memory", "150MB", "-o", "out")
        self.assertEqual(done.returncode, MEMORY, done.stderr)
        self.assertIn("reference", done.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_trapped_light_is_said(self):
        done = self.run_tool("convergence", "room.obj", "--patches", 100, "-o", "out", "--set", "white.reflectance=1",
                             "--set", "lamp.reflectance=1")
        self.assertEqual(done.returncode, NOT_CONVERGED, done.stderr)
        self.assertRegex(done.stderr, r"\b[1-9]\d* patch")
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
