"""patchlight compare-solvers: every solver on one matrix, to the same true error."""
import csv
import json
import math
import unittest

from support import ToolTest, content, is_one_message

GOOD, USAGE, NOT_CONVERGED, OUTPUT = 0, 1, 3, 6
STORED = ["jacobi", "gauss-seidel", "sor", "symmetric-gauss-seidel", "chebyshev", "progressive", "overshooting", "cg",
          "deflated-cg", "gmres", "bicgstab"]
PLOTS = [f"error_by_{x}.{kind}" for x in ("application", "iteration", "second") for kind in ("png", "svg")]


class CompareTest(ToolTest):
    def compare(self, *words, out="out", model="room.obj"):
        done = self.run_tool("compare-solvers", model, "--patches", 300, "-o", out, *words)
        self.assertEqual(done.returncode, GOOD, done.stderr)
        self.assertNotIn("warning", done.stderr)
        return done, json.loads((self.folder / out / "compare.json").read_text())

    def rows(self, name):
        with (self.folder / "out" / name).open(newline="") as lines:
            return list(csv.DictReader(lines))

    def test_every_solver_reaches_the_same_true_error(self):
        done, facts = self.compare()
        runs = {run["solver"]: run for run in facts["runs"]}
        self.assertEqual(list(runs), STORED + ["progressive-on-demand"])
        for name in STORED:
            run = runs[name]
            self.assertTrue(run["reached"], name)
            self.assertLessEqual(run["true_error"], 1e-6)
            # The run stops at the first iterate that is accurate enough. The bound is relative to the iterate and the
            # error to the reference, which differ by less than a thousandth here. So the bound is not below the error.
            self.assertTrue(all(row["true_error"] > 1e-6 for row in run["history"][:-1]), name)
            late = [row for row in run["history"] if row["true_error"] < 1e-3]
            self.assertTrue(all(row["error_bound"] >= 0.999 * row["true_error"] for row in late), name)
            self.assertAlmostEqual(run["history"][0]["true_error"], 1, 12)
            self.assertIn(name, done.stdout)
        self.assertLess(facts["reference_relative_residual"], 1e-9)
        # Rows on demand are not closed, so they cannot reach the same error.
        self.assertFalse(runs["progressive-on-demand"]["reached"])
        self.assertEqual(runs["progressive-on-demand"]["iterations"], 1)

    def test_jacobi_converges_with_the_spectral_radius(self):
        """Its error is multiplied by K in every iteration: late in the run by the largest eigenvalue.

        The rate is taken over the last third of the fall, some fifteen iterations from the thirtieth on. What the second
        eigenvalue, at most .75 of the first, leaves of its share there is .75^30 = 2e-4; 2 % is what is promised.
        """
        _, facts = self.compare("--solvers", "jacobi", "--tolerance", "1e-9")
        self.assertLess(abs(facts["runs"][0]["rate"] / facts["spectral_radius"] - 1), 0.02)
        # Row sums of the closed room are 1 within 1e-9.
        self.assertLess(facts["spectral_radius"], facts["highest_reflectance"] * (1 + 1e-9))

    def test_the_spectral_radius_is_that_of_the_room_whatever_lights_it(self):
        _, by_lamp = self.compare("--solvers", "cg")
        self.write("lit.toml", '[[model]]\nfile = "room.obj"\n'
                   '[[luminaire]]\nkind = "point"\nposition = [0.5, 0.5, 0.5]\nlumens = 800\n')
        _, by_luminaire = self.compare("--solvers", "cg", "--set", "lamp.exitance=0", out="lit", model="lit.toml")
        self.assertGreater(by_luminaire["spectral_radius"], 0)
        self.assertAlmostEqual(by_luminaire["spectral_radius"] / by_lamp["spectral_radius"], 1, 3)

    def test_tables_say_what_the_json_says(self):
        _, facts = self.compare("--solvers", "cg,progressive,progressive-on-demand")
        table = {row["solver"]: row for row in self.rows("compare.csv")}
        history = self.rows("history.csv")
        for run in facts["runs"]:
            for key in ("iterations", "applications", "seconds", "seconds_with_assembly", "true_error"):
                self.assertAlmostEqual(float(table[run["solver"]][key]) / run[key], 1, 7)
            rows = [row for row in history if row["solver"] == run["solver"]]
            self.assertEqual(len(rows), len(run["history"]))
            for row, of_json in zip(rows, run["history"]):
                self.assertTrue(math.isclose(float(row["applications"]), of_json["applications"], rel_tol=1e-8))

    def test_folder(self):
        self.compare("--solvers", "cg,jacobi")
        names = sorted(path.name for path in (self.folder / "out").iterdir())
        self.assertEqual(names, sorted(PLOTS + ["cg.pvd", "cg_series", "compare.csv", "compare.json", "history.csv",
                                                "jacobi.pvd", "jacobi_series"]))
        # A second run replaces the first one completely.
        self.compare("--solvers", "sor", "--no-series", "--relaxation", 1.1)
        names = sorted(path.name for path in (self.folder / "out").iterdir())
        self.assertEqual(names, sorted(PLOTS + ["compare.csv", "compare.json", "history.csv"]))

    def test_what_is_not_ours_stays(self):
        self.write("out", "")
        (self.folder / "out").unlink()
        (self.folder / "out").mkdir()
        (self.folder / "out" / "thesis.tex").write_text("mine")
        before = content(self.folder)
        done = self.run_tool("compare-solvers", "room.obj", "--patches", 100, "-o", "out")
        self.assertEqual(done.returncode, OUTPUT)
        self.assertEqual(content(self.folder), before)

    def test_who_gives_up_is_named(self):
        done = self.run_tool("compare-solvers", "room.obj", "--patches", 100, "-o", "out", "--max-iterations", 2, "--solvers",
                             "jacobi,cg")
        self.assertEqual(done.returncode, NOT_CONVERGED)
        self.assertIn("jacobi, cg", done.stderr)
        self.assertTrue((self.folder / "out" / "compare.json").exists())

    def test_refusals(self):
        for words in (["--solvers", "cg,cg"], ["--solvers", ""], ["--solvers", "newton"], ["--tolerance", "0"],
                      ["--relaxation", "2"], ["--relaxation", "1.2", "--solvers", "cg"], ["--estimator", "area"]):
            done = self.run_tool("compare-solvers", "room.obj", "-o", "out", *words)
            self.assertEqual(done.returncode, USAGE, words)
            self.assertTrue(is_one_message(done.stderr), done.stderr)
            self.assertIn(words[0], done.stderr)

    def test_trapped_light_is_said(self):
        """Reflectance 1 everywhere, including the lamp, in a closed room."""
        done = self.run_tool("compare-solvers", "room.obj", "--patches", 100, "-o", "out", "--set", "white.reflectance=1",
                             "--set", "lamp.reflectance=1")
        self.assertEqual(done.returncode, NOT_CONVERGED, done.stderr)
        self.assertRegex(done.stderr, r"\b[1-9]\d* patch")
        self.assertFalse((self.folder / "out").exists())

    def test_without_reflection_there_is_nothing_to_do(self):
        _, facts = self.compare("--set", "white.reflectance=0")
        for run in facts["runs"]:
            self.assertTrue(run["reached"])
            self.assertEqual((run["iterations"], run["true_error"]), (0, 0))


if __name__ == "__main__":
    unittest.main()
