"""`patchlight solve --method on-demand` gives the result of a stored matrix without closure, in little memory."""
import json
import math
import unittest

from support import ToolTest

USAGE, NOT_CONVERGED, MEMORY = 1, 3, 4
TOLERANCE = 1e-7


class OnDemandTest(ToolTest):
    def report(self, *arguments, code=0):
        done = self.run_tool("solve", "room.obj", "--solver", "progressive", "--json", "report.json", *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        return json.loads((self.folder / "report.json").read_text())

    reports = []

    def both(self):
        """The reports of both methods, computed once."""
        size = ("--patches", 300, "--tolerance", TOLERANCE)
        if not self.reports:
            self.reports.extend([self.report(*size, "--no-closure"), self.report(*size, "--method", "on-demand")])
        return self.reports

    def difference(self, report, band):
        """A bound on ||B_1 - B_2||_A for two solutions of the same equations: each stops at ||B* - B||_A <=
        tolerance ||B - E||_A, and ||B - E||_A <= sqrt(A) max rho H."""
        reflected = max(m["reflectance"][band] * m["irradiance_max_W_m2"][band] for m in report["materials"])
        return 2 * TOLERANCE * math.sqrt(report["mesh"]["area_m2"]) * reflected

    def test_agrees_with_the_stored_matrix(self):
        """On the patches of a material of area A, H = (B - E) / rho, so by Cauchy and Schwarz its mean has an error
        of at most ||B_1 - B_2||_A / (rho sqrt(A))."""
        stored, on_demand = self.both()
        self.assertTrue(on_demand["solution"]["converged"])
        self.assertEqual(on_demand["mesh"]["area_m2"], stored["mesh"]["area_m2"])
        compared = 0
        for band in range(3):
            for one, other in zip(stored["materials"], on_demand["materials"]):
                reflectance = one["reflectance"][band]
                if reflectance == 0:
                    continue
                expected = one["irradiance_mean_W_m2"][band]
                delta = self.difference(stored, band) / (reflectance * math.sqrt(one["area_m2"]))
                self.assertLess(delta, 1e-4 * expected)
                self.assertAlmostEqual(other["irradiance_mean_W_m2"][band], expected, delta=delta)
                compared += 1
        self.assertEqual(compared, 3)

    def test_what_is_not_known_is_null(self):
        """Without row sums the defect of the form factors counts as imbalance. Two solutions determine it: their
        absorbed fluxes differ by at most sum A |B_1 - B_2| (1 + 1 / rho) <= sqrt(A) ||B_1 - B_2||_A (1 + 1 / rho).
        The 1 is for the lamp, which does not reflect; the solver's own imbalance is as small."""
        stored, on_demand = self.both()
        transport = on_demand["transport"]
        for key in ("facing_pairs", "shadow_rays", "raw_row_sum", "row_sum"):
            self.assertIsNone(transport[key], key)
        self.assertEqual(transport["worst_rows"], [])
        self.assertTrue(transport["closure"].startswith("none: "))
        self.assertEqual((on_demand["plan"]["storage"], on_demand["plan"]["close"]), ("on-demand", False))
        balance = on_demand["energy_balance"]
        self.assertIsNone(balance["defect_W"])

        known = stored["energy_balance"]
        defect = max(abs(lost) / emitted for lost, emitted in zip(known["defect_W"], known["emitted_W"]))
        root_of_area = math.sqrt(stored["mesh"]["area_m2"])
        delta = max(2 * root_of_area * self.difference(stored, band) * (1 + 1 / 0.5) / known["emitted_W"][band]
                    for band in range(3))
        self.assertGreater(defect, delta)
        self.assertAlmostEqual(balance["imbalance"], defect, delta=delta)

    def test_every_output_is_written(self):
        self.write("spots.txt", "0 0 0 0 0 1\n")
        done = self.run_tool("solve", "room.obj", "--patches", 200, "--solver", "progressive", "--method", "on-demand", "-v", "-o",
                             "a.vtp", "-o", "a.glb", "--series", "a.pvd", "--picture", "a.png", "--size", "80x60",
                             "--points", "spots.txt")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("computed on demand", done.stdout)
        self.assertIn(b"radiosity", (self.folder / "a.vtp").read_bytes())
        self.assertNotIn(b'"row_sum"', (self.folder / "a.vtp").read_bytes())

    def test_a_first_picture_after_a_share_of_the_rows(self):
        """The lamps take one row each, and so does each shot. The picture includes an estimate of unshot light,
        which the summary mentions."""
        report = self.report("--patches", 400, "--method", "on-demand", "--max-rows", "10%", "--picture", "early.png",
                             "--size", "80x60", code=NOT_CONVERGED)
        last = report["solution"]["iterations"][-1]
        self.assertEqual(report["request"]["max_rows"], 0.1)
        self.assertLessEqual(last["work"], 0.1)
        self.assertGreater(last["work"], 0.1 - 1 / report["mesh"]["patches"])
        done = self.run_tool("solve", "room.obj", "--solver", "overshooting", "--patches", 400, "--max-rows", "10%",
                             "--picture", "early.png", "--size", "80x60", "--json", "early.json")
        self.assertEqual(done.returncode, NOT_CONVERGED)
        early = json.loads((self.folder / "early.json").read_text())
        self.assertIs(early["solution"]["converged"], False)
        work = early["solution"]["iterations"][-1]["work"]
        self.assertLessEqual(work, 0.1)
        self.assertGreater(work, 0.1 - 1 / early["mesh"]["patches"])
        self.assertTrue((self.folder / "early.png").exists())

    def test_a_number_of_rays_takes_rays(self):
        def report_with(*options):
            done = self.run_tool("solve", "room.obj", "--patches", 200, "--json", "report.json", *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            return json.loads((self.folder / "report.json").read_text())

        report = report_with("--rays", 128)
        self.assertEqual((report["plan"]["storage"], report["plan"]["rays"], report["request"]["rays"]),
                         ("rays", 128, 128))
        fewer = report_with("--method", "rays")
        self.assertEqual(fewer["plan"]["rays"], 64)
        self.assertLess(report["relative_error"]["form_factor"], fewer["relative_error"]["form_factor"])
        done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--rays", 128, "--method", "pairs")
        self.assertEqual(done.returncode, USAGE)
        for name in ("--rays", "--method pairs", "--method rays"):
            self.assertIn(name, done.stderr)

    def test_shares_of_rows_that_are_refused(self):
        for text in ("5", "0%", "-5%", "%", "5%%", "nan%", "five%"):
            done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--solver", "progressive", "--max-rows", text)
            self.assertEqual(done.returncode, USAGE, text)
            self.assertIn(f"--max-rows: found '{text}'", done.stderr)
        done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--max-rows", "5%")
        self.assertEqual(done.returncode, USAGE)
        for name in ("--max-rows", "--solver cg", "--solver progressive or overshooting"):
            self.assertIn(name, done.stderr)

    def test_needs_no_memory_for_pairs(self):
        """4,000 patches: 32 MB for the pairs, 50 MB for the program."""
        size = ("--patches", 4000, "--memory", "75MB", "--max-iterations", 0)
        refused = self.run_tool("solve", "room.obj", "--solver", "progressive", "--json", "report.json", *size)
        self.assertEqual(refused.returncode, MEMORY, refused.stderr)
        accepted = self.report(*size, "--method", "on-demand", code=NOT_CONVERGED)
        self.assertGreater(accepted["mesh"]["patches"], 3000)
        self.assertLess(accepted["memory_peak_bytes"], 75e6)


if __name__ == "__main__":
    unittest.main()
