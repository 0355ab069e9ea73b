"""Every command that computes light warns of faces missing from its model, even with --quiet."""
import unittest

from support import ToolTest

# The object "gone" has no face with an area; the wall loses a face with two corners.
GONE = "o gone\nf 1 2 2\n"
SHORT = "f 1 2\n"


class LossesTest(ToolTest):
    def warnings(self, *arguments):
        done = self.run_tool(*arguments, "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, "")
        return [line for line in done.stderr.splitlines() if line.startswith("patchlight: warning: ")]

    def test_all_commands_warn_of_a_lost_object(self):
        model = (self.folder / "room.obj").read_text()
        self.write("short.obj", model + SHORT)
        self.write("gone.obj", model + GONE)
        few = ["--patches", 40]
        for name, expected in (("short.obj", 0), ("gone.obj", 1)):
            commands = {
                "solve": [*few, "-o", "out.vtp"],
                "render": ["--solution", "out.vtp", "-o", "out.png", "--size", "16x16"],
                "compare-solvers": [*few, "-o", "compared"],
                "convergence": [*few, "-o", "studied"],
                "crosscheck": [*few, "--paths", 100],
                "form-factors": [*few, "-o", "factors"],
            }
            for command, words in commands.items():
                self.assertEqual(len(self.warnings(command, name, *words)), expected, f"{command} {name}")
        # Stored form factors remember the missing faces.
        self.assertEqual(len(self.warnings("relight", "factors", "-o", "again.vtp")), 1)


if __name__ == "__main__":
    unittest.main()
