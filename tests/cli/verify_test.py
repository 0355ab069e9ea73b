"""patchlight crosscheck: a solution against path tracing."""
import json
import os
import pathlib
import re
import unittest

from support import ROOM, ToolTest

GOOD, USAGE, INPUT, NOT_CONVERGED, DIFFERS, OUTPUT = 0, 1, 2, 3, 5, 6
CORNELL_BOX = pathlib.Path(os.environ["PATCHLIGHT_MESHES"]).resolve() / "cornell_box.obj"


class VerifyTest(ToolTest):
    def test_cornell_box_agrees_and_the_json_tells_the_same(self):
        done = self.run_tool("crosscheck", CORNELL_BOX, "--patches", 2000, "--sides", "front", "--json", "out.json")
        self.assertEqual((done.returncode, done.stderr), (GOOD, ""), done.stdout)
        lines = done.stdout.splitlines()
        facts = json.loads((self.folder / "out.json").read_text())
        self.assertRegex(lines[0], rf"^agrees: .* {100 * facts['relative_error']['total']:.2g} % ")
        self.assertTrue(facts["agrees"])
        self.assertGreater(facts["relative_error"]["total"], 0)
        self.assertGreaterEqual(facts["probability"], facts["least_probability"])
        self.assertEqual((len(facts["checked"]), facts["paths_per_patch"]), (64, 4096))
        chi_square = [0, 0, 0]
        for patch in facts["checked"]:
            for band in range(3):
                ours, traced = patch["irradiance_W_m2"][band], patch["traced_W_m2"][band]
                error, bar = patch["standard_error_W_m2"][band], patch["bar_W_m2"][band]
                self.assertAlmostEqual(patch["z"][band], (ours - traced) / error, 6)
                chi_square[band] += (ours - traced) ** 2 / (error ** 2 * 31 / 29 + bar ** 2)
        part, = facts["parts"]
        self.assertEqual((part["part"], part["checked"]), ("all", 64))
        for band in range(3):
            self.assertAlmostEqual(part["chi_square"][band] / chi_square[band], 1, 9)
        # The worst patches come first, each with its place.
        head = next(k for k, line in enumerate(lines) if line.startswith("place "))
        rows = lines[head + 1:]
        self.assertEqual(len(rows), 10)
        sizes = [abs(float(row.split()[-1])) for row in rows]
        self.assertEqual(sizes, sorted(sizes, reverse=True))
        self.assertTrue(all("cornell_box.obj:" in row for row in rows))
        self.assertEqual(lines[head].split()[:5], ["place", "object", "material", "side", "position,"])
        self.assertEqual({patch["side"] for patch in facts["checked"]}, {"front"})
        self.assertTrue(all(" front " in row for row in rows))

    def test_figures_are_those_of_the_json(self):
        """Between the verdict and the table: stated, then measured errors, each with its number."""
        done = self.run_tool("crosscheck", "room.obj", "--patches", 300, "--paths", 512, "--json", "out.json")
        facts = json.loads((self.folder / "out.json").read_text())
        part = facts["parts"][0]
        worst = max(range(3), key=lambda band: part["chi_square"][band])
        bars, typical, mean, chi_square = (float(re.search(r"-?\d[\d.]*(?:e-?\d+)?", line)[0])
                                           for line in done.stdout.splitlines() if line.startswith("  "))
        self.assertGreater(bars, 0)
        self.assertGreater(typical, 0)
        self.assertAlmostEqual(chi_square, part["chi_square"][worst], delta=0.01 * chi_square)
        self.assertTrue(any(abs(mean - 100 * part["mean_difference"][band]) <= 0.01 * abs(mean) for band in range(3)))
        self.assertIn(f" {facts['least_probability']} ", done.stdout.replace("\n", " "))

    def test_quiet_says_nothing_where_they_agree(self):
        for option in ("-q", "--quiet"):
            done = self.run_tool("crosscheck", "room.obj", "--patches", 300, "--paths", 512, option)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (GOOD, "", ""))
        done = self.run_tool("crosscheck", "room.obj", "--patches", 50, "--margin", "0%", "--paths", 16384, "-q")
        self.assertEqual((done.returncode, done.stdout), (DIFFERS, ""))
        self.assertRegex(done.stderr, r"^patchlight: warning: DISAGREES: [^\n]*\n$")

    def test_two_rooms_agree(self):
        done = self.run_tool("crosscheck", CORNELL_BOX.parent / "two_rooms.obj", "--sides", "front")
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)

    def test_two_rooms_agree_by_rows_of_rays(self):
        """Without pairs: up to 1.5 % of the light is noise, which the bars must include."""
        done = self.run_tool("crosscheck", CORNELL_BOX.parent / "two_rooms.obj", "--sides", "front", "--method", "rays",
                             "--patches", 3000)
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)

    def test_a_bar_may_be_given_instead(self):
        done = self.run_tool("crosscheck", "room.obj", "--patches", 300, "--margin", "5%", "--json", "out.json")
        self.assertIn(" 5 % ", done.stdout.splitlines()[0])
        facts = json.loads((self.folder / "out.json").read_text())
        self.assertIsNone(facts["relative_error"])
        # The outer sides of the room are dark.
        self.assertIn(f": {len(facts['left_out_sides'])} ", done.stdout)
        self.assertEqual({side["lit"] for side in facts["left_out_sides"]}, {False})
        for patch in facts["checked"]:
            for ours, bar in zip(patch["irradiance_W_m2"], patch["bar_W_m2"]):
                self.assertGreaterEqual(bar, 0.05 * ours)

    def test_an_accuracy_is_reached_first(self):
        done = self.run_tool("crosscheck", "room.obj", "--accuracy", "3%", "--json", "out.json")
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)
        self.assertIn("below 3 %", done.stderr)
        self.assertLessEqual(json.loads((self.folder / "out.json").read_text())["relative_error"]["total"], 0.03)

    def test_lamps_close_to_a_surface_are_in_the_verdict(self):
        """A lamp 1 mm above the floor that faces it: only the gap lights the room."""
        self.write("room.obj", ROOM.replace("usemtl lamp\n", "v 0.4 0.4 0.001\nv 0.6 0.4 0.001\nv 0.6 0.6 0.001\n"
                                            "v 0.4 0.6 0.001\nusemtl lamp\nf 20 19 18 17\n"))
        done = self.run_tool("crosscheck", "room.obj", "--patches", 60, "--paths", 256, "--margin", "1%")
        self.assertIn("close_lamp: ", done.stderr)
        verdict = done.stdout.splitlines()[0]
        self.assertRegex(verdict, r"^(agrees|DISAGREES|INCONCLUSIVE): .*\bclose_lamp\b")

    def test_wide_bars_are_inconclusive(self):
        """Bars of 45 % accept any error of a coarse mesh."""
        done = self.run_tool("crosscheck", "room.obj", "--patches", 50, "--margin", "45%", "--paths", 256, "--json", "out.json")
        self.assertEqual(done.returncode, DIFFERS, done.stdout)
        self.assertRegex(done.stdout, r"INCONCLUSIVE: .* 45 % .* 10 %")
        facts = json.loads((self.folder / "out.json").read_text())
        self.assertEqual((facts["verdict"], facts["agrees"]), ("inconclusive", False))
        self.assertGreater(facts["parts"][0]["width"], facts["widest_bar"])

    def test_too_few_patches_disagree(self):
        """Without a margin, the error of a coarse mesh is many times the noise."""
        done = self.run_tool("crosscheck", "room.obj", "--patches", 50, "--margin", "0%", "--paths", 16384)
        self.assertEqual(done.returncode, DIFFERS, done.stdout)
        self.assertIn("DISAGREES", done.stdout)

    def test_the_same_seed_gives_the_same_words(self):
        def words(*options):
            lines = self.run_tool("crosscheck", "room.obj", "--patches", 100, "--paths", 256, *options).stdout.splitlines()
            return [line for line in lines if " rays in " not in line]
        self.assertEqual(words("--threads", 1), words("--threads", 2))
        self.assertNotEqual(words(), words("--seed", 2))

    def test_what_does_not_converge_is_not_verified(self):
        done = self.run_tool("crosscheck", "room.obj", "--set", "white.reflectance=1", "--set", "lamp.reflectance=1",
                             "--patches", 100)
        self.assertEqual(done.returncode, NOT_CONVERGED, done.stdout)
        self.assertIn("not verified", done.stderr)

    def test_refusals(self):
        for words, code in ((["room.obj", "--margin", "a"], USAGE), (["room.obj", "--margin", "-1"], USAGE),
                            (["room.obj", "--estimator", "area"], USAGE),
                            (["room.obj", "--paths", "0"], USAGE), (["room.obj", "--json", "a.txt"], USAGE),
                            ([], USAGE), (["missing.obj"], INPUT), (["room.obj", "--json", "missing/a.json"], OUTPUT)):
            done = self.run_tool("crosscheck", *words)
            self.assertEqual((done.returncode, done.stdout), (code, ""), words)


if __name__ == "__main__":
    unittest.main()
