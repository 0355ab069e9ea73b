"""patchlight selftest: cases with known results and a verdict each."""
import json
import os
import pty
import subprocess
import unittest

from support import TOOL, ToolTest

GOOD, USAGE, OUTPUT = 0, 1, 6


class ValidateTest(ToolTest):
    def test_table_and_json_tell_the_same(self):
        done = self.run_tool("selftest", "--json", "validation.json")
        self.assertEqual(done.returncode, GOOD, done.stdout + done.stderr)
        report = json.loads((self.folder / "validation.json").read_text())
        self.assertTrue(report["sound"])
        self.assertGreaterEqual(len(report["cases"]), 30)
        for case in report["cases"]:
            self.assertIn(case["case"], done.stdout)
            self.assertLessEqual(abs(case["computed"] - case["exact"]), case["error_bar"], case["case"])
            self.assertTrue(case["within_bar"])
            # A very wide bar would prove nothing: an error of two percent must show.
            self.assertLess(case["error_bar"], 0.02 * abs(case["exact"]), case["case"])
            self.assertTrue(case["exact_from"] and case["error_bar_from"])
        self.assertIn(f"{len(report['cases'])} cases, 0 ", done.stdout)

    def test_a_terminal_shows_which_case_is_at_work(self):
        ours, theirs = pty.openpty()
        with subprocess.Popen([TOOL, "selftest"], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=theirs) as process:
            os.close(theirs)
            shown = b""
            while b"case 2 of " not in shown:  # the end of the run closes the terminal, which is an error here
                shown += os.read(ours, 4096)
            process.kill()
        os.close(ours)
        self.assertRegex(shown.decode(), r"case 1 of \d+")

    def test_refusals(self):
        for words, code in ((["--json", "a.txt"], USAGE), (["--jsn"], USAGE), (["room.obj"], USAGE),
                            (["--threads", "-1"], USAGE), (["--json", "missing/a.json"], OUTPUT)):
            self.assertEqual(self.run_tool("selftest", *words).returncode, code, words)


if __name__ == "__main__":
    unittest.main()
