"""Commands warn of findings that can make all results wrong, even with --quiet: lost faces, an implausible unit."""
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

    def test_solve_warns_of_a_scene_file_whose_unit_is_not_that_of_its_model(self):
        # The room of 2 m in millimeters: the unit of a scene file holds for its own lengths alone.
        lines = (self.folder / "room.obj").read_text().splitlines()
        self.write("mm.obj", "\n".join(
            "v " + " ".join(str(1000 * float(word)) for word in line.split()[1:]) if line.startswith("v ") else line
            for line in lines) + "\n")
        for of_model, expected in (("", 1), ('unit = "mm"\n', 0)):
            self.write("scene.toml", f'unit = "mm"\n[[model]]\nfile = "mm.obj"\n{of_model}')
            warnings = self.warnings("solve", "scene.toml", "--patches", 40, "-o", "out.vtp")
            self.assertEqual(len(warnings), expected, warnings)
            self.assertTrue(all("implausible_size" in warning for warning in warnings))


if __name__ == "__main__":
    unittest.main()
