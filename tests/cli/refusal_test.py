"""Impossible requests are refused with one sentence on stderr and the documented exit code, and change no file."""
import unittest

from support import MATERIALS, ROOM, ToolTest, content, is_one_message

USAGE, INPUT, MEMORY, OUTPUT = 1, 2, 4, 6


class RefusalTest(ToolTest):
    def setUp(self):
        super().setUp()
        for name in ("room.vtp", "room.png", "room.json", "spots.irradiance.csv"):
            self.write(name, "an older result")
        self.write("spots.txt", "0 0 0.5 0 0 1\n")

    def assert_refused(self, code, named, *arguments):
        """The run fails with this code and one sentence that has each of these words; the folder stays unchanged."""
        before = content(self.folder)
        done = self.run_tool(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(is_one_message(done.stderr), done.stderr)
        self.assertTrue(done.stderr.startswith("patchlight: error: "), done.stderr)
        for word in named:
            self.assertIn(word, done.stderr)
        self.assertEqual(content(self.folder), before)

    def assert_model_refused(self, named, model="room.obj"):
        outputs = ("-o", "room.vtp", "--picture", "room.png", "--json", "room.json", "--points", "spots.txt")
        self.assert_refused(INPUT, named, "solve", model, *outputs)

    def test_missing_file(self):
        self.assert_model_refused(["missing.obj"], model="missing.obj")

    def test_near_names_of_files_and_commands(self):
        self.assert_refused(INPUT, ["rom.obj", " 'room.obj'?"], "solve", "rom.obj", "-o", "room.vtp")
        self.assert_refused(INPUT, [" './room.obj'?"], "check", "./rooom.obj")
        self.assert_refused(USAGE, ["'sovle'", " 'solve'?"], "sovle", "room.obj")
        self.assertNotIn("mean", self.run_tool("check", "quite_another.obj").stderr)
        self.assertNotIn("mean", self.run_tool("check", "rom.obj", "--confine", "elsewhere").stderr)

    def test_camera(self):
        for words, named in ((("1,2", "0,0,1", "60"), "e.g. 4,-3,1.6"), (("1,2,3",), "hint: --camera 4,-3,1.6 0,0,1 60"),
                             (("1,2,3", "0,0,1", "up"), "e.g. --camera 4,-3,1.6 0,0,1 60")):
            self.assert_refused(USAGE, ["--camera", named], "solve", "room.obj", "--picture", "room.png", "--camera", *words)

    def test_coordinate_that_is_not_a_number(self):
        self.write("room.obj", ROOM.replace("v 1 1 0\n", "v 1 nan 0\n"))
        self.assert_model_refused(["room.obj:4"])

    def test_coordinate_that_is_not_finite(self):
        self.write("room.obj", ROOM.replace("v 1 1 0\n", "v 1 inf 0\n"))
        self.assert_model_refused(["room.obj:4"])

    def test_reflectance_above_one(self):
        self.write("room.mtl", MATERIALS.replace("Kd 0.7 0.6 0.5", "Kd 0.7 1.6 0.5"))
        self.assert_model_refused(["white", "1.6"])

    def test_no_emitter(self):
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ke 0 0 0"))
        self.assert_model_refused(["room.obj"])

    def test_empty_file(self):
        self.write("empty.obj", "")
        self.assert_model_refused(["empty.obj"], model="empty.obj")

    def test_folder_as_model(self):
        (self.folder / "folder.obj").mkdir()
        self.assert_model_refused(["folder.obj"], model="folder.obj")

    def test_unknown_format(self):
        self.write("room.xyz", "")
        self.assert_model_refused(["room.xyz"], model="room.xyz")

    def test_unknown_material_in_set(self):
        arguments = ("solve", "room.obj", "-o", "room.vtp", "--set", "brass.reflectance=0.5")
        self.assert_refused(INPUT, ["brass"], *arguments)

    def test_bad_line_of_points(self):
        for line, named in (("0 0 1 0 0", "found 5"), ("0 0 1 0 0 up", "'up'"), ("0 0 1 0 0 0", "zero")):
            with self.subTest(line):
                self.write("spots.txt", "# x y z nx ny nz\n\n" + line + "\n")
                self.assert_refused(INPUT, ["spots.txt:3", named], "solve", "room.obj", "--points", "spots.txt")

    def test_missing_points(self):
        self.assert_refused(INPUT, ["no.txt"], "solve", "room.obj", "--points", "no.txt")
        self.assert_refused(INPUT, ["is a folder"], "solve", "room.obj", "--points", ".", "--points-output", "a.csv")

    def test_output_that_cannot_be_written(self):
        (self.folder / "folder.vtp").mkdir()
        for output in ("nowhere/room.vtp", "room.obj/room.vtp", "folder.vtp"):
            with self.subTest(output):
                self.assert_refused(OUTPUT, [output], "solve", "room.obj", "-o", output)

    def test_series_that_cannot_be_written(self):
        self.write("a_series", "a file in the way")
        self.assert_refused(OUTPUT, ["a_series"], "solve", "room.obj", "--series", "a.pvd")
        self.assert_refused(OUTPUT, ["no/a.pvd"], "solve", "room.obj", "--series", "no/a.pvd")

    def test_more_than_the_memory_allowed(self):
        """Half of the n^2 pairs with four bytes each: 40,000 patches need just over 3.2 GB."""
        solve = ("solve", "room.obj", "-o", "room.vtp")
        for size in ("2GB", "2 GB", "2e9", "1900MiB", "1.8GiB", "2000000kB"):
            with self.subTest(size):
                named = ["40000 patches", "3.3", "--memory", "--patches"]
                self.assert_refused(MEMORY, named, *solve, "--method", "pairs", "--patches", 40000, "--memory", size)
        self.assert_refused(MEMORY, ["patches", "--memory"], *solve, "--max-edge", "0.005", "--memory", "1GB")
        self.assert_refused(MEMORY, ["program itself"], *solve, "--memory", "10MB")
        # No machine has this memory; the run must fail before it makes a single patch.
        self.assert_refused(MEMORY, ["patches"], *solve, "--patches", 1000000000)
        self.assert_refused(MEMORY, ["patches"], *solve, "--max-edge", "1e-9")

    def test_every_output_is_checked_before_any_is_written(self):
        for option, output in (("--picture", "no/a.png"), ("--json", "no/a.json"), ("--points-output", "no/a.csv")):
            with self.subTest(option):
                arguments = ("solve", "room.obj", "-o", "room.vtp", "--points", "spots.txt", option, output)
                self.assert_refused(OUTPUT, [output], *arguments)

    def test_unknown_option(self):
        solve = ("solve", "room.obj", "-o", "room.vtp")
        self.assert_refused(USAGE, ["--max-egde", "--max-edge"], *solve, "--max-egde", "0.1")
        self.assert_refused(USAGE, ["--max-egde=1", "--max-edge"], *solve, "--max-egde=1")
        self.assert_refused(USAGE, ["--frobnicate", "--help"], *solve, "--frobnicate")
        self.assert_refused(USAGE, ["-x"], *solve, "-x")
        self.assert_refused(USAGE, ["--frobnicate"], "--frobnicate")
        render = ("render", "room.obj", "--solution", "room.vtp")
        for words in (("--picture", "a.png"), ("--picture=a.png",)):
            self.assert_refused(USAGE, ["unknown option --picture", "-o VIEW.png"], *render, *words)

    def test_unknown_command(self):
        self.assert_refused(USAGE, ["sovle", "solve"], "sovle", "room.obj")
        self.assert_refused(USAGE, ["solve"])

    def test_a_file_in_place_of_a_command(self):
        """The message suggests the intended command."""
        self.write("two words.OBJ", ROOM)
        self.write("notes.txt", "")
        for words, line in ((["room.obj"], "room.obj -o room.vtp"), (["far/missing.ifc"], "far/missing.ifc -o missing.vtp"),
                            (["two words.OBJ"], "'two words.OBJ' -o 'two words.vtp'"),
                            (["room.obj", "--patches", "9", "-o", "a.ply"], "room.obj --patches 9 -o a.ply")):
            with self.subTest(line):
                self.assert_refused(USAGE, [f"'{words[0]}'", f"patchlight solve {line}\n"], *words)
        # For an existing file that is not a model, the suggestion would be wrong.
        self.assert_refused(USAGE, ["'notes.txt'"], "notes.txt")
        self.assertNotIn("patchlight solve", self.run_tool("notes.txt").stderr)

    def test_second_model_missing(self):
        self.assert_refused(INPUT, ["other.obj", "does not exist"], "solve", "room.obj", "other.obj", "-o", "room.vtp")

    def test_number_out_of_range(self):
        for option, values in {
            "--max-edge": ("0", "-1", "nan", "inf", "wide", "1x", ""),
            "--patches": ("0", "-5", "1.5", "many"),
            "--tolerance": ("0", "1", "-1e-6", "nan"),
            "--samples": ("3", "-1", "16.5"),
            "--max-iterations": ("-1", "ten"),
            "--seed": ("-1", "x", "99999999999999999999999"),
            "--threads": ("-1", "two"),
            "--memory": ("0", "-1GB", "2 pounds", "GB", "1e", ""),
        }.items():
            for value in values:
                with self.subTest(option + " " + value):
                    self.assert_refused(USAGE, [option, "expected"], "solve", "room.obj", "-o", "a.vtp", option, value)

    def test_unknown_word_gets_the_list_of_allowed_ones(self):
        for option, allowed in {
            "--solver": ["jacobi", "gauss-seidel", "sor", "symmetric-gauss-seidel", "chebyshev", "progressive",
                         "overshooting", "cg", "deflated-cg", "gmres", "bicgstab"],
            "--unit": ["mm", "cm", "m", "in", "ft"],
            "--up": ["y", "z"],
            "--sides": ["auto", "front", "both"],
            "--false-color": ["luminance"],
        }.items():
            with self.subTest(option):
                named = [option, "'strange'", *allowed]
                self.assert_refused(USAGE, named, "solve", "room.obj", "--picture", "a.png", option, "strange")

    def test_malformed_setting(self):
        for setting in ("white", "white.reflectance", "white.colour=1,1,1", "white.reflectance=1,x,1", ".exitance=1"):
            with self.subTest(setting):
                self.assert_refused(USAGE, ["--set"], "solve", "room.obj", "-o", "a.vtp", "--set", setting)

    def test_malformed_camera(self):
        for camera in (("0,0,0",), ("0,0", "1,1,1", "40"), ("0,0,0", "1,1,1", "180"), ("0,0,0", "0,0,0", "40")):
            with self.subTest(camera):
                arguments = ("solve", "room.obj", "--picture", "a.png", "--camera", *camera)
                self.assert_refused(USAGE, ["--camera"], *arguments)

    def test_option_without_its_value(self):
        self.assert_refused(USAGE, ["--tolerance"], "solve", "room.obj", "-o", "a.vtp", "--tolerance")

    def test_options_that_need_or_exclude_another(self):
        self.assert_refused(USAGE, ["-o", "--picture", "--json", "--points"], "solve", "room.obj")
        self.assert_refused(USAGE, ["model"], "solve", "-o", "a.vtp")
        solve = ("solve", "room.obj", "-o", "a.vtp")
        self.assert_refused(USAGE, ["--max-edge", "--patches"], *solve, "--max-edge", "1", "--patches", "9")
        self.assert_refused(USAGE, ["--camera", "--picture"], *solve, "--camera", "0,0,0", "1,1,1", "40")
        self.assert_refused(USAGE, ["--false-color", "--picture"], *solve, "--false-color", "luminance")
        self.assert_refused(USAGE, ["--points-output", "--points"], *solve, "--points-output", "a.csv")
        self.assert_refused(USAGE, ["--quiet", "-v"], *solve, "--quiet", "-v")
        for option, value in (("--accuracy", "2%"), ("--time-limit", "30s")):
            self.assert_refused(USAGE, ["--no-refine", option], *solve, "--no-refine", option, value)
        self.assert_refused(USAGE, ["--method on-demand", "--solver progressive"], *solve, "--method", "on-demand", "--solver", "cg")
        on_demand = (*solve, "--method", "on-demand", "--solver", "progressive")
        for option, *value in (("--no-closure",), ("--form-factors", "a.ff"), ("--estimator", "area")):
            self.assert_refused(USAGE, ["--method on-demand", option], *on_demand, option, *value)

    def test_wrong_extension(self):
        self.assert_refused(USAGE, ["-o", "a.vtk", ".vtp", ".ply", ".glb"], "solve", "room.obj", "-o", "a.vtk")
        self.assert_refused(USAGE, ["--series", "a.vtp", ".pvd"], "solve", "room.obj", "--series", "a.vtp")
        self.assert_refused(USAGE, ["--picture", "a.jpg", ".png"], "solve", "room.obj", "--picture", "a.jpg")

    def test_one_file_for_two_purposes(self):
        self.assert_refused(USAGE, ["room.obj"], "solve", "room.obj", "--json", "./room.obj")
        self.assert_refused(USAGE, ["a.png"], "solve", "room.obj", "--picture", "a.png", "--json", "a.png")


if __name__ == "__main__":
    unittest.main()
