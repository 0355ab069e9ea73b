"""Several files as one scene, and models from the standard input."""
import subprocess
import unittest

from support import ROOM, TOOL, ToolTest

SQUARE_OFF = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"
USAGE, INPUT = 1, 2


class FormatsTest(ToolTest):
    def solve(self, *arguments, text=""):
        words = [str(argument) for argument in ("solve", *arguments, "--patches", 100, "-o", "out.vtp", "--quiet")]
        return subprocess.run([TOOL, *words], cwd=self.folder, input=text, capture_output=True, text=True, timeout=600,
                              check=False)

    def spots(self, *arguments, text=""):
        """The irradiance at one point of the floor."""
        self.write("spots.txt", "0 0 0 0 0 1\n")
        done = self.solve(*arguments, "--points", "spots.txt", "--points-output", "spots.csv", text=text)
        self.assertEqual(done.returncode, 0, done.stderr)
        return (self.folder / "spots.csv").read_text()

    def test_standard_errors_of_sensors_say_where_they_guess(self):
        self.write("spots.txt", "0 0 0 0 0 1\n")
        for options, guesses in ((["--no-error-bars"], True), ([], False)):
            words = ["solve", "room.obj", "--patches", "100", "-o", "out.vtp", "--points", "spots.txt", *options]
            done = self.run_tool(*words)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("only an estimate" in done.stdout, guesses, done.stdout)

    def test_two_files_are_one_scene(self):
        room, lamp = ROOM.split("usemtl lamp\n")
        vertices = [line for line in ROOM.splitlines() if line.startswith(("v ", "mtllib"))]
        self.write("walls.obj", room)
        self.write("lamp.obj", "\n".join(vertices) + "\nusemtl lamp\n" + lamp)
        self.assertEqual(self.spots("walls.obj", "lamp.obj"), self.spots("room.obj"))

    def test_standard_input_is_obj(self):
        self.assertEqual(self.spots("-", text=ROOM), self.spots("room.obj"))

    def test_standard_input_in_another_format(self):
        done = self.solve("-", "--format", "off", "--set", "default.radiance=1", text=SQUARE_OFF)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_empty_standard_input_is_refused(self):
        done = self.solve("-")
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("is empty", done.stderr)

    def test_unknown_format_is_refused_with_the_list(self):
        done = self.solve("room.obj", "--format", "max")
        self.assertEqual(done.returncode, USAGE)
        self.assertIn("obj, ply, stl, off, dae, ifc, gltf, glb", done.stderr)

    def test_an_output_may_not_replace_any_model(self):
        self.write("lamp.vtp", ROOM)
        done = self.run_tool("solve", "room.obj", "lamp.vtp", "--format", "obj", "-o", "lamp.vtp")
        self.assertEqual(done.returncode, USAGE)
        self.assertEqual((self.folder / "lamp.vtp").read_text(), ROOM)


if __name__ == "__main__":
    unittest.main()
