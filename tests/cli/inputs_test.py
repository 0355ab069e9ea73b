"""No output replaces an input, whatever its name is; confined runs read nothing outside of their folder."""
import os
import unittest

from support import MATERIALS, ROOM, ToolTest, content

USAGE, INPUT, OUTPUT = 1, 2, 6

IES = """IESNA:LM-63-2002
TILT=NONE
1 1000 1 3 1 1 2 0 0 0
1 1 100
0 45 90
0
300 200 0
"""
SCENE = '''[[model]]
file = "room.obj"
[[sensors]]
name = "desk"
file = "spots.pts"
[[luminaire]]
kind = "ies"
file = "lamp.ies"
position = [0, 0, 1.5]
'''


class InputsTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("room.mtl", MATERIALS + "map_Kd wood.png\n")
        self.write("wood.png", "not read, but the model names it")
        self.write("spots.pts", "0 0 0.5 0 0 1\n")
        self.write("lamp.ies", IES)
        self.write("scene.toml", SCENE)

    def assert_refused(self, code, named, *arguments):
        before = content(self.folder)
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, code, (arguments, done.stderr))
        for word in named:
            self.assertIn(word, done.stderr)
        self.assertEqual(content(self.folder), before)

    def test_what_a_scene_file_or_a_model_names_is_not_replaced(self):
        """An output of each kind is a link to the file, or another path to it."""
        solve = ("solve", "scene.toml", "--patches", "40", "-q")
        for file in ("room.obj", "room.mtl", "wood.png", "spots.pts", "lamp.ies", "scene.toml"):
            for suffix, option in ((".vtp", "-o"), (".pvd", "--series"), (".json", "--json"), (".png", "--picture"),
                                   (".csv", "--points-output")):
                link = self.folder / ("link" + suffix)
                link.symlink_to(file)
                with self.subTest(file=file, option=option):
                    self.assert_refused(USAGE, [option, file], *solve, option, link.name)
                link.unlink()
            link = self.folder / "link.json"
            link.symlink_to(file)
            for command in ("check", "plan"):
                with self.subTest(file=file, command=command):
                    self.assert_refused(USAGE, ["--json", file], command, "scene.toml", "--json", "link.json")
            link.unlink()
        self.assert_refused(USAGE, ["--picture", "wood.png"], *solve, "--picture", "../" + self.folder.name + "/wood.png")

    def test_the_default_file_of_readings_is_no_input(self):
        self.write("scene.toml", SCENE.replace("spots.pts", "scene.irradiance.csv"))
        self.write("scene.irradiance.csv", "0 0 0.5 0 0 1\n")
        self.assert_refused(USAGE, ["scene.irradiance.csv"], "solve", "scene.toml", "--patches", "40", "-q", "-o", "a.vtp")

    def test_a_model_within_the_folder_that_is_replaced(self):
        folder = self.folder / "results"
        folder.mkdir()
        (folder / "info.json").write_text("{}")
        (folder / "facts.json").symlink_to("../room.obj")
        os.rename(self.folder / "room.mtl", folder / "room.mtl")
        self.write("room.obj", ROOM.replace("mtllib room.mtl", "mtllib results/room.mtl"))
        for command in ("form-factors", "compare-solvers", "convergence"):
            with self.subTest(command):
                done = self.run_tool(command, "room.obj", "--patches", "40", "-o", "results")
                self.assertIn(done.returncode, (USAGE, OUTPUT))
                self.assertEqual((folder / "room.mtl").read_text(), MATERIALS + "map_Kd wood.png\n")

    def test_two_outputs_are_two_files(self):
        solve = ("solve", "room.obj", "--patches", "40", "-q")
        self.assert_refused(USAGE, ["-o", "./c.vtp"], *solve, "-o", "c.vtp", "-o", "./c.vtp")
        (self.folder / "link.vtp").symlink_to("new.vtp")
        self.assert_refused(USAGE, ["-o", "link.vtp"], *solve, "-o", "new.vtp", "-o", "link.vtp")
        (self.folder / "other").symlink_to(".")
        self.assert_refused(USAGE, ["-o", "other/c.vtp"], *solve, "-o", "c.vtp", "-o", "other/c.vtp")

    def test_a_link_to_nothing_yet_is_followed(self):
        (self.folder / "link.vtp").symlink_to("new.vtp")
        done = self.run_tool("solve", "room.obj", "--patches", "40", "-q", "-o", "link.vtp")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "link.vtp").is_symlink())
        self.assertGreater((self.folder / "new.vtp").stat().st_size, 1000)

    def test_links_in_a_circle_and_long_names(self):
        for name in ("a.obj", "b.obj", "a.vtp", "b.vtp", "a.pts", "b.pts"):
            (self.folder / name).symlink_to(name.translate(str.maketrans("ab", "ba")) if name[1] == "." else name)
        solve = ("solve", "room.obj", "--patches", "40", "-q", "-o")
        self.assert_refused(INPUT, ["a.obj"], "check", "a.obj")
        self.assert_refused(OUTPUT, ["a.vtp"], *solve, "a.vtp")
        self.assert_refused(INPUT, ["a.pts"], *solve, "c.vtp", "--points", "a.pts")
        long = 300 * "x"
        self.assert_refused(INPUT, [long], "check", long + ".obj")
        self.assert_refused(OUTPUT, [long], *solve, long + ".vtp")
        self.assert_refused(OUTPUT, [long], *solve, "c.vtp", "--series", long + ".pvd")
        self.assert_refused(INPUT, [long], *solve, "c.vtp", "--points", long, "--points-output", "c.csv")
        self.assert_refused(INPUT, [long], *solve, "c.vtp", "--form-factors", long)
        for command in ("form-factors", "compare-solvers", "convergence"):
            self.assert_refused(OUTPUT, [long], command, "room.obj", "--patches", "40", "-o", long)
        for command in ("check", "plan", "crosscheck"):
            self.assert_refused(OUTPUT, [long], command, "room.obj", "--json", long + ".json")

    def test_confined_to_a_folder(self):
        """Refusals of files outside do not reveal whether they exist; files inside are read as usual."""
        inside = self.folder / "inside"
        inside.mkdir()
        for name in ("room.obj", "room.mtl", "spots.pts", "lamp.ies", "scene.toml"):
            (inside / name).write_text((self.folder / name).read_text())
        check = ("check", "inside/scene.toml", "--confine", "inside")
        self.assertEqual(self.run_tool(*check).returncode, 0)
        self.assert_refused(INPUT, ["room.obj", "--confine"], "check", "room.obj", "--confine", "inside")
        for name, missing in (("room.obj", "none.obj"), ("spots.pts", "none.pts"), ("lamp.ies", "none.ies")):
            for relative in (True, False):
                messages = []
                for other in (name, missing):
                    path = "../" + other if relative else str(self.folder / other)
                    (inside / "scene.toml").write_text(SCENE.replace(name, path))
                    done = self.run_tool(*check)
                    self.assertEqual(done.returncode, INPUT, done.stderr)
                    messages.append(done.stderr.replace(other, "X"))
                self.assertEqual(messages[0], messages[1])
        (inside / "scene.toml").write_text(SCENE)
        (inside / "room.obj").write_text(ROOM.replace("mtllib room.mtl", "mtllib ../room.mtl"))
        self.assert_refused(INPUT, ["room.mtl", "--confine"], *check)
        (inside / "room.obj").unlink()
        (inside / "room.obj").symlink_to("../room.obj")
        self.assert_refused(INPUT, ["room.obj", "--confine"], *check)


if __name__ == "__main__":
    unittest.main()
