"""Outputs of `patchlight solve`: all files with the same bytes for any number of threads, or none if it is stopped."""
import csv
import json
import os
import pathlib
import pty
import re
import signal
import subprocess
import unittest

from support import TOOL, ToolTest

OPTIONS = """--output --series --json --picture --false-color --camera --view --points --points-output --format --unit --up
--sides --set --max-edge --patches --accuracy --time-limit --focus --error-bars --method --solver --tolerance
--max-iterations --samples --seed --threads --memory --discard --quiet --verbose --help""".split()

DOCS = pathlib.Path(__file__).resolve().parent.parent.parent / "docs"
NOT_CONVERGED = 3
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


# The share of the run has risen in this stage.
SOLVING = rb"(?s)solve, ([0-9]+) %.*solve, (?!\1 )[0-9]+ %"


class SolveTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("spots.txt", "# a comment\n0 0 0 0 0 1\n\n-0.5, 0.5, 0, 0, 0, 2  # any length\n")

    def solve(self, *arguments, code=0):
        done = self.run_tool("solve", "room.obj", *arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def read(self, name):
        return (self.folder / name).read_bytes()

    def names(self):
        return {path.name for path in self.folder.iterdir()}

    def test_help_names_every_option(self):
        done = self.run_tool("solve", "--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for option in OPTIONS:
            self.assertRegex(done.stdout, re.escape(option) + r"\b")

    def test_help_gives_every_default(self):
        text = self.run_tool("solve", "--help").stdout
        entries = re.split(r"\n  (?=-)", text.split("\nModel:")[1])[1:]
        self.assertGreater(len(entries), 15)
        for entry in entries:
            if not entry.startswith("-h,"):
                self.assertIn("efault", entry)

    def test_each_command_has_a_short_help_and_a_full_one(self):
        listed = re.findall(r"(?m)^  ([a-z][a-z-]+)  ", self.run_tool("--help").stdout)
        self.assertEqual(len([name for name in listed if name != "help"]), 12)
        for command in listed:
            short, full = (self.run_tool(command, option).stdout for option in ("-h", "--help"))
            self.assertLessEqual(len(short.splitlines()), 50, command)
            self.assertGreaterEqual(short.count(f"\n  patchlight {command} "), 2 if command == "selftest" else 3 - (command == "relight"))
            self.assertLess(len(short), len(full), command)
            for line in re.findall(r"(?m)^  -.*\n(      \S.*)$", full):
                self.assertLessEqual(len(line), 86, line)

    def test_a_command_that_is_given_nothing_shows_its_short_help(self):
        for command in ("solve", "check", "relight"):
            done = self.run_tool(command)
            self.assertEqual((done.returncode, done.stdout), (1, ""))
            self.assertEqual(done.stderr, self.run_tool(command, "-h").stdout)

    def test_help_on_a_topic(self):
        self.assertEqual(self.run_tool("help", "solve").stdout, self.run_tool("solve", "--help").stdout)
        self.assertEqual(self.run_tool("help").stdout, self.run_tool("--help").stdout)
        for topic, page in (("daylight", "concepts/daylight.md"), ("index", "index.md"), ("formats", "reference/formats/index.md")):
            self.assertEqual(self.run_tool("help", topic).stdout, (DOCS / page).read_text(encoding="utf-8"))
        done = self.run_tool("help", "no-such-topic")
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("no-such-topic", done.stderr)

    def test_former_names_still_work(self):
        done = self.solve("--patches", 100, "-o", "a.vtp", "--storage", "tiles", "--force", "occlusion", "--report", "a.json")
        self.assertEqual(done.stderr.count(" is now --"), 3, done.stderr)
        self.assertRegex(done.stderr, r"note: --force .*--enable\b")
        self.assertEqual(json.loads((self.folder / "a.json").read_text())["request"]["force"], ["occlusion"])
        self.assertEqual(self.solve("--patches", 100, "-q", "-o", "a.vtp", "--keep-mesh").stderr, "")

    def test_version(self):
        done = self.run_tool("--version")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"\Apatchlight \d+\.\d+\.\d+\n\Z")

    def test_all_outputs(self):
        done = self.solve("--patches", 300, "-o", "out.vtp", "--picture", "out.png", "--json", "out.json",
                          "--points", "spots.txt")
        for name in ("out.vtp", "out.png", "out.json", "spots.irradiance.csv"):
            self.assertIn(name, done.stdout)
        self.assertEqual(self.names() - {"room.obj", "room.mtl", "spots.txt"},
                         {"out.vtp", "out.png", "out.json", "spots.irradiance.csv"})
        self.assertTrue(self.read("out.png").startswith(b"\x89PNG"))
        self.assertIn(b"<VTKFile", self.read("out.vtp")[:200])
        json.loads(self.read("out.json"))
        rows = list(csv.reader(self.read("spots.irradiance.csv").decode().splitlines()))
        self.assertEqual(rows[0][:6], ["x", "y", "z", "nx", "ny", "nz"])
        self.assertEqual([len(row) for row in rows], [len(rows[0])] * 3)
        self.assertEqual(rows[2][:6], ["-0.5", "0.5", "0", "0", "0", "2"])
        self.assertTrue(all(float(value) > 0 for value in rows[1][6:9]))

    def test_points_output_goes_beside_the_result(self):
        (self.folder / "results").mkdir()
        self.solve("--patches", 100, "-o", "results/out.vtp", "--points", "spots.txt")
        self.assertTrue((self.folder / "results" / "spots.irradiance.csv").is_file())

    def test_units_scale_everything_alike(self):
        """Irradiance depends on angles only: the same model in other units has the same irradiance, up to rounding."""
        values = []
        for unit in ("m", "in"):
            self.solve("--unit", unit, "--max-edge", 0.4, "--points", "spots.txt", "--points-output", unit + ".csv")
            rows = list(csv.reader(self.read(unit + ".csv").decode().splitlines()))[1:]
            values.append([float(value) for row in rows for value in row[6:9]])
        for in_metres, in_inches in zip(*values):
            self.assertAlmostEqual(in_inches / in_metres, 1, delta=1e-4)

    def test_light_adds_up(self):
        """B is linear in E: twice the radiance of a lamp gives twice the irradiance, to the bit, since 2 is a power
        of two."""
        values = []
        for radiance in (8, 16):
            self.solve("--patches", 200, "--set", f"lamp.radiance={radiance}", "--points", "spots.txt",
                       "--points-output", "spots.csv")
            rows = list(csv.reader(self.read("spots.csv").decode().splitlines()))[1:]
            values.append([float(value) for row in rows for value in row[6:9]])
        for single, double in zip(*values):
            self.assertAlmostEqual(double / single, 2, delta=1e-5)  # the written digits

    def test_noise_of_rays_in_the_flux_is_said(self):
        """R rays with equal parts of the flux, 64 per patch, have a relative error of 1 / sqrt(R). A much smaller
        imbalance, as in the closed room, needs no explanation."""
        box = pathlib.Path(os.environ["PATCHLIGHT_MESHES"]).resolve() / "cornell_box.obj"
        for model, is_said in ((box, True), ("room.obj", False)):
            done = self.run_tool("solve", model, "--method", "rays", "--patches", 900, "--json", "a.json")
            report = json.loads(self.read("a.json"))
            imbalance = report["energy_balance"]["imbalance"]
            usual = (64 * report["mesh"]["patches"]) ** -0.5
            shown = self.imbalance_shown(done)
            self.assertAlmostEqual(shown[0] / imbalance, 1, delta=0.1)
            self.assertEqual((len(shown), imbalance > usual / 10), (1 + is_said, is_said), done.stdout)
            if is_said:
                self.assertAlmostEqual(shown[1] / usual, 1, delta=0.5)
        pairs = self.run_tool("solve", box, "--method", "pairs", "--patches", 900, "--json", "b.json")
        self.assertEqual(len(self.imbalance_shown(pairs)), 1)

    def imbalance_shown(self, done):
        """The imbalance in the summary, and the usual one by the noise of the rays where the summary has it."""
        return [float(number) for number in re.findall(r"\d[\d.]*(?:e-?\d+)?", re.search(r"imbalance.*", done.stdout)[0])]

    def test_same_bytes_for_any_number_of_threads(self):
        for threads in (1, 2):
            self.solve("--patches", 500, "--threads", threads, "--picture", f"{threads}.png", "--points", "spots.txt",
                       "--points-output", f"{threads}.csv")
        self.assertEqual(self.read("1.csv"), self.read("2.csv"))
        self.assertEqual(self.read("1.png"), self.read("2.png"))

    def test_camera_and_false_colors_change_the_picture(self):
        self.solve("--patches", 100, "--picture", "1.png", "--camera", "-0.9,-0.9,1.5", "0,0,0.5", 60)
        self.solve("--patches", 100, "--picture", "2.png", "--camera", "-0.9,-0.9,1.5", "0,0,0.5", 60,
                   "--false-color", "luminance")
        self.solve("--patches", 100, "--picture", "3.png", "--camera", "-0.9,-0.9,1.5", "0,0,0.5", 90)
        self.assertEqual(len({self.read(f"{k}.png") for k in (1, 2, 3)}), 3)

    def test_quiet_says_nothing_and_verbose_says_more(self):
        quiet = self.solve("--patches", 100, "-o", "out.vtp", "--quiet")
        self.assertEqual((quiet.stdout, quiet.stderr), ("", ""))
        normal = self.solve("--patches", 100, "-o", "out.vtp")
        verbose = self.solve("--patches", 100, "-o", "out.vtp", "-v")
        self.assertNotIn("shadow rays", normal.stdout)
        self.assertIn("shadow rays", verbose.stdout)
        self.assertNotRegex(normal.stderr, r"\r")  # no progress line if stderr is not a terminal

    def test_not_converged_is_written_and_explained(self):
        """With white walls of reflectance 0.99999 only the lamp absorbs, and Jacobi needs tens of thousands of
        iterations."""
        done = self.solve("--patches", 100, "--set", "white.reflectance=0.99999", "--solver", "jacobi", "-o", "out.vtp",
                          code=NOT_CONVERGED)
        self.assertIn("out.vtp", self.names())
        self.assertIn("NOT converged", done.stderr)
        self.assertIn("0.99999", done.stderr)

    def test_what_noise_of_rays_does_not_explain_is_not_put_down_to_it(self):
        """After two bounces about 15 % of the flux is unshot, and the noise of all rays is 1 / sqrt(R) = 0.4 %."""
        done = self.solve("--patches", 900, "--method", "rays", "--solver", "jacobi", "--max-iterations", 2,
                          "--json", "a.json", code=NOT_CONVERGED)
        found, usual = self.imbalance_shown(done)
        self.assertGreater(found, 10 * usual)

    def test_interrupt_leaves_no_file(self):
        for sent in SIGNALS:
            with self.subTest(sent.name):
                before = self.names()
                shown, code = self.interrupt_in_stage(b"form factors", sent)
                self.assertEqual(code, 128 + sent, shown)
                self.assertIn(b"interrupted", shown)
                self.assertEqual(self.names(), before)

    def test_interrupt_writes_what_is_there(self):
        """A solution on demand takes minutes; its last iterate is available at any time."""
        options = ["--method", "on-demand", "--patches", "4000", "--json", "out.json"]
        outputs = {"out.vtp", "out.png", "out.json"}
        for sent in SIGNALS:
            with self.subTest(sent.name):
                shown, code = self.interrupt_in_stage(SOLVING, sent, options)
                self.assertEqual(code, 128 + sent, shown)
                self.assertIn(b"UNFINISHED", shown)
                self.assertLessEqual(outputs, self.names())
                solution = json.loads(self.read("out.json"))["solution"]
                self.assertEqual((solution["unfinished"], solution["converged"]), (True, False))
                for name in outputs:
                    (self.folder / name).unlink()

    def test_the_solution_is_written_before_the_sensors_are_read(self):
        (self.folder / "many.txt").write_text("".join(f"{0.6 + k * 1e-6} 0.6 0.5 0 0 1\n" for k in range(300_000)))
        options = ["--patches", "500", "--points", "many.txt", "--points-output", "read.csv"]
        shown, code = self.interrupt_in_stage(rb"gather, [1-9]", signal.SIGKILL, options)
        self.assertEqual(code, -signal.SIGKILL, shown)
        self.assertIn("out.vtp", self.names())
        self.assertNotIn("read.csv", self.names())

    def test_interrupt_tells_of_no_sensor_that_was_not_read(self):
        """The solution takes a moment, its 300,000 points take minutes."""
        (self.folder / "many.txt").write_text("".join(f"{0.6 + k * 1e-6} 0.6 0.5 0 0 1\n" for k in range(300_000)))
        options = ["--patches", "500", "--points", "many.txt", "--points-output", "read.csv", "--json", "out.json"]
        shown, code = self.interrupt_in_stage(rb"gather, [1-9]", signal.SIGINT, options)
        self.assertEqual(code, 128 + signal.SIGINT, shown)
        self.assertLessEqual({"out.vtp", "out.json"}, self.names())
        self.assertNotIn("read.csv", self.names())
        self.assertNotIn("sensors", json.loads(self.read("out.json")))
        self.assertNotIn("largest ±".encode(), shown)

    def test_interrupt_discards_when_asked(self):
        for sent in SIGNALS:
            with self.subTest(sent.name):
                before = self.names()
                options = ["--method", "on-demand", "--patches", "4000", "--discard"]
                shown, code = self.interrupt_in_stage(SOLVING, sent, options)
                self.assertEqual(code, 128 + sent, shown)
                self.assertEqual(self.names(), before)

    def interrupt_in_stage(self, stage, sent, options=("--patches", "12000", "--method", "pairs", "--samples", "4096")):
        """Starts a run of minutes on a terminal and sends the signal during the stage; returns the terminal's text
        and the exit code."""
        ours, theirs = pty.openpty()
        command = [TOOL, "solve", "room.obj", *options, "-o", "out.vtp", "--picture", "out.png"]
        with subprocess.Popen(command, cwd=self.folder, stdout=theirs, stderr=theirs) as process:
            os.close(theirs)
            shown = b""
            while not re.search(stage, shown):
                shown += os.read(ours, 4096)
            process.send_signal(sent)
            # The tool reacts within a second; a run that ignores the signal takes minutes.
            code = process.wait(timeout=30)
            try:
                while part := os.read(ours, 4096):
                    shown += part
            except OSError:  # the terminal is closed at the other end
                pass
            os.close(ours)
        return shown, code


if __name__ == "__main__":
    unittest.main()
