"""patchlight validate: cases with known answers, with a verdict each."""
import json
import unittest

from support import ToolTest

GOOD, USAGE, OUTPUT = 0, 1, 6


class ValidateTest(ToolTest):
    def test_table_and_json_tell_the_same(self):
        done = self.run_tool("validate", "--json", "validation.json")
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)
        report = json.loads((self.folder / "validation.json").read_text())
        self.assertTrue(report["sound"])
        self.assertGreaterEqual(len(report["cases"]), 30)
        for case in report["cases"]:
            self.assertIn(case["case"], done.stdout)
            self.assertLessEqual(abs(case["computed"] - case["exact"]), case["error_bar"], case["case"])
            self.assertTrue(case["within_bar"])
            self.assertTrue(case["exact_from"] and case["error_bar_from"])
        self.assertIn(f"{len(report['cases'])} cases, 0 outside", done.stdout)

    def test_refusals(self):
        for words, code in ((["--json", "a.txt"], USAGE), (["--jsn"], USAGE), (["room.obj"], USAGE),
                            (["--threads", "-1"], USAGE), (["--json", "missing/a.json"], OUTPUT)):
            self.assertEqual(self.run_tool("validate", *words).returncode, code, words)


if __name__ == "__main__":
    unittest.main()
