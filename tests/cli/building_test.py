"""A typical building: daylight and effects on the command line, a new scene file, and a short report of `check`."""
import json
import unittest

from support import ToolTest

USAGE, INPUT, OUTPUT = 1, 2, 6
NO_LAMP = "newmtl wall\nKd .5 .5 .5\nnewmtl pane\nKd 0 0 0\nd .2\n"
# A floor of 4 m x 3 m, and a roof with a hole of 1 m x 1 m over it.
COURT = """mtllib court.mtl
v 0 0 0
v 4 0 0
v 4 3 0
v 0 3 0
v 0 0 3
v 4 0 3
v 4 1 3
v 0 1 3
g floor
usemtl wall
f 1 2 3 4
g roof
f 5 8 7 6
"""


# A floor of 4 m x 3 m with walls of 3 m, and a roof with a slit of 0.4 m over them.
HALL = """mtllib court.mtl
v 0 0 0
v 4 0 0
v 4 3 0
v 0 3 0
v 0 0 3
v 4 0 3
v 4 3 3
v 0 3 3
v 4 2.6 3
v 0 2.6 3
g floor
usemtl wall
f 1 2 3 4
g walls
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
g roof
f 5 10 9 6
"""


class BuildingTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("court.obj", COURT)
        self.write("hall.obj", HALL)
        self.write("court.mtl", NO_LAMP)

    def good(self, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, code, parts, *arguments):
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)

    def test_options_give_the_light_of_a_scene_file(self):
        self.write("court.toml", 'up = "z"\n[[model]]\nfile = "court.obj"\n[sky]\nkind = "overcast"\n'
                                 'illuminance = 8000\n[ground]\nreflectance = 0.1\n')
        rest = ["--patches", 200, "--up", "z", "-q", "--json"]
        self.good("solve", "court.toml", *rest, "file.json")
        self.good("solve", "court.obj", "--sky", "overcast:8000lx", "--ground", "0.1", *rest, "options.json")
        of_file, of_options = (json.loads((self.folder / name).read_text()) for name in ("file.json", "options.json"))
        self.assertEqual(of_file["energy_balance"], of_options["energy_balance"])
        self.assertGreater(of_file["energy_balance"]["arriving_W"][0], 1)

    def test_what_cannot_be_understood_is_refused(self):
        for option, value, parts in (
                ("--sky", "foggy", ["overcast, uniform, clear, perez"]),
                ("--sky", "overcast:dark", ["illuminance in lx"]),
                ("--sky", "perez:300", ["perez:DIRECT,DIFFUSE"]),
                ("--sun", "100,0:5lx", ["altitude"]),
                ("--sun", "2024-13-01T12:00:00Z@50,10:5lx", ["day of the calendar"]),
                ("--sun", "2024-02-30T12:00:00Z@50,10:5lx", ["day of the calendar"]),
                ("--sun", "2024-02-29T12:00:00+15:00@50,10:5lx", ["day of the calendar"]),
                ("--ground", "2", ["0 to 1"]),
                ("--weather", "city.epw@13-1-5", ["MONTH-DAY-HOUR"])):
            self.refused(USAGE, [option, *parts], "solve", "court.obj", option, value, "-o", "x.vtp")
        self.refused(INPUT, ["--sky", "hint: --sun "], "plan", "court.obj", "--sky", "clear")
        self.refused(INPUT, ["--exclude", " 'floor'?"], "plan", "court.obj", "--sky", "overcast",
                     "--exclude", "flor")

    def test_a_guessed_upright_axis_is_warned_of_where_light_depends_on_it(self):
        """A tall box that is open at the top looks as if y were upright. -q hides no warning of wrong results."""
        self.write("box.obj", "mtllib court.mtl\nusemtl stone\n"
                              "v 0 0 0\nv 4 0 0\nv 4 1 0\nv 0 1 0\nv 0 0 3\nv 4 0 3\nv 4 1 3\nv 0 1 3\n"
                              "f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n")
        run = ("solve", "box.obj", "--sky", "overcast:1000lx", "--patches", 100, "-q", "--json", "a.json")
        guessed = self.run_tool(*run)
        self.assertEqual(guessed.returncode, 0, guessed.stderr)
        self.assertIn("warning: guessed_up: box.obj: ", guessed.stderr)
        self.assertIn("--up z", guessed.stderr)
        self.assertNotIn("--up", self.run_tool(*run, "--up", "z").stderr)
        self.assertIn("guessed_up", self.run_tool("check", "box.obj", "--sky", "overcast").stdout)
        self.write("box.toml", '[[model]]\nfile = "box.obj"\n[sun]\ndirection = [0, 0, 1]\nilluminance = 100\n')
        self.assertNotIn("--up", self.run_tool("plan", "box.toml").stderr)
        self.write("box.toml", '[[model]]\nfile = "box.obj"\n[sky]\nkind = "overcast"\nilluminance = 100\n')
        self.assertIn("--up", self.run_tool("plan", "box.toml").stderr)

    def test_a_model_without_lamps_is_told_of_the_sky(self):
        self.refused(INPUT, ["--sky overcast:10000lx", "patchlight init MODEL -o SCENE.toml"], "solve", "court.obj",
                     "-o", "x.vtp")

    def test_what_is_left_out_does_not_take_part(self):
        self.assertIn("1 polygon of 12 m^2", self.good("check", "court.obj", "--sky", "overcast", "--only", "floor"))

    def sensors_of(self, scene):
        self.good("solve", scene, "--patches", 200, "-q", "-o", "x.vtp", "--points-output", "x.csv")
        return (self.folder / "x.csv").read_text().splitlines()[1:]

    def test_a_new_scene_file_can_be_solved_and_is_not_overwritten(self):
        self.good("init", "hall.obj", "-o", "hall.toml")
        text = (self.folder / "hall.toml").read_text()
        self.assertIn('file = "hall.obj"', text)
        self.assertIn("[sky]\nkind", text)
        self.assertIn('floor = "floor"', text)
        # EN 12464-1: cells of 0.2 * 5^log10(4) = 0.53 m over 3 m x 2 m.
        self.assertEqual(len(self.sensors_of("hall.toml")), 6 * 4)
        self.refused(OUTPUT, ["hall.toml", "exists"], "init", "hall.obj", "-o", "hall.toml")
        self.assertEqual((self.folder / "hall.toml").read_text(), text)
        self.refused(USAGE, ["patchlight init MODEL -o SCENE.toml"], "init", "hall.obj")

    def test_a_new_scene_file_has_no_sensors_in_the_open(self):
        self.good("init", "court.obj", "-o", "court.toml")
        self.assertNotIn("\n[[sensors]]", (self.folder / "court.toml").read_text())
        self.good("check", "court.toml")
        self.good("solve", "court.toml", "--patches", 200, "-q", "-o", "court.vtp")

    def test_a_new_scene_file_can_be_solved_whatever_the_unit(self):
        """A hall in millimeters that is read in meters is 4,000 m long, which is not a room."""
        hall = (self.folder / "hall.obj").read_text().splitlines()
        self.write("mm.obj", "\n".join("v " + " ".join(str(1000 * float(x)) for x in line.split()[1:4])
                                       if line.startswith("v ") else line for line in hall) + "\n")
        done = self.run_tool("init", "mm.obj", "-o", "mm.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("--unit mm", done.stderr)
        self.good("solve", "mm.toml", "--patches", 200, "-q", "-o", "mm.vtp")
        self.good("init", "mm.obj", "--unit", "mm", "-o", "right.toml")
        self.assertEqual(len(self.sensors_of("right.toml")), 6 * 4)

    def test_check_tells_of_a_great_many_sensors(self):
        self.good("init", "hall.obj", "-o", "hall.toml")
        text = (self.folder / "hall.toml").read_text()
        self.write("fine.toml", text.replace("# spacing = 0.5 ", "spacing = 0.005 "))
        said = self.good("check", "fine.toml")
        self.assertRegex(said, r"implausible_size: \d{6} .*'work plane' \(\S*fine\.toml:\d+\)")
        self.assertNotIn("implausible_size", self.good("check", "hall.toml"))
        # The run stops early: without mesh and patches, the memory limit refuses it later.
        done = self.run_tool("solve", "fine.toml", "--patches", 50, "--memory", "1kB", "-o", "fine.vtp")
        self.assertRegex(done.stderr, r"note: implausible_size: \d{6} ")

    def test_check_fits_on_a_screen(self):
        names = [f"m{k}" for k in range(80)]
        self.write("many.mtl", "".join(f"newmtl {name}\nKd .5 .5 .5\n" for name in names))
        faces = "".join(f"v {k} 0 0\nv {k + 1} 0 0\nv {k + 1} 1 0\nv {k} 1 0\ng g{k}\nusemtl {name}\n"
                        "f -4 -3 -2 -1\n" for k, name in enumerate(names))
        self.write("many.obj", "mtllib many.mtl\n" + faces)
        short = self.good("check", "many.obj", "--sky", "overcast")
        self.assertLessEqual(len(short.splitlines()), 50)
        self.assertRegex(short, r"\b68\b.*--all\b")
        every = self.good("check", "many.obj", "--sky", "overcast", "--all")
        for name in names:
            self.assertIn(f"  {name} ", every)


if __name__ == "__main__":
    unittest.main()
