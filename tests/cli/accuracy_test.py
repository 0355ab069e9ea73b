"""`patchlight solve --accuracy`, `--time-limit`, `--error-bars`: requested, stated and refused accuracies."""
import json
import math
import re
import struct
import time
import unittest

from support import ROOM, ToolTest

GOOD, USAGE, INPUT, NOT_REACHED, MEMORY = 0, 1, 2, 3, 4
BARS = ("mesh", "form_factor", "solver", "total", "display")
ARRAYS = ("error_mesh", "error_form_factor", "error_total", "display_error", "error_irradiance")
# Both sides of the plate, the front of the lamp and the inner sides of the room are included.
AREA = 6 * 4 + 2 * 1 + 0.25

OFFICE_MODEL = """mtllib office.mtl
v 0 0 0
v 4 0 0
v 4 5 0
v 0 5 0
v 0 0 3
v 4 0 3
v 4 5 3
v 0 5 3
v -4 -6 -.2
v 8 -6 -.2
v 8 -.1 -.2
v -4 -.1 -.2
o room
usemtl plaster
f 1 2 3 4
f 5 8 7 6
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
usemtl pane
f 1 5 6 2
o outside
usemtl ground
f 9 10 11 12
"""
OFFICE_MATERIALS = "newmtl plaster\nKd .6 .6 .6\nnewmtl pane\nKd .1 .1 .1\nnewmtl ground\nKd .2 .2 .2\n"
OFFICE = """up = "z"

[[model]]
file = "office.obj"

[[material]]
name = "pane"
transmittance = 0.8

[sun]
direction = [-0.3, -0.6, 0.6]
illuminance = 5000

[sky]
kind = "overcast"
illuminance = 4000
"""


def faces_of(ply):
    """The corners of every face of a binary PLY by `patchlight solve`."""
    header, body = ply.split(b"end_header\n", 1)
    vertices, faces = (int(re.search(rf"element {name} (\d+)".encode(), header)[1]) for name in ("vertex", "face"))
    at = struct.Struct("<3d3B")
    points = [at.unpack_from(body, k * at.size)[:3] for k in range(vertices)]
    offset, found = vertices * at.size, []
    for _ in range(faces):
        count = body[offset]
        found.append([points[k] for k in struct.unpack_from(f"<{count}i", body, offset + 1)])
        offset += 1 + 4 * count
    assert offset == len(body)
    return found


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def area_of(face):
    return sum(math.hypot(*cross(minus(b, face[0]), minus(c, face[0]))) / 2 for b, c in zip(face[1:], face[2:]))


class AccuracyTest(ToolTest):
    def solve(self, *arguments, code=GOOD):
        done = self.run_tool("solve", "room.obj", *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def report(self, *arguments, code=GOOD):
        done = self.solve("--json", "report.json", *arguments, code=code)
        return json.loads((self.folder / "report.json").read_text()), done

    def body(self, name):
        """The body of a PLY without its header, which holds the command line."""
        return (self.folder / name).read_bytes().split(b"end_header\n", 1)[1]

    def test_inside_and_outside_are_stated_apart_and_may_be_named(self):
        """A closed room with a pane as one of its walls, on lit ground."""
        self.write("office.toml", OFFICE)
        self.write("office.obj", OFFICE_MODEL)
        self.write("office.mtl", OFFICE_MATERIALS)
        done = self.run_tool("solve", "office.toml", "--patches", 300, "--error-bars", "--json", "report.json")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        spaces = json.loads((self.folder / "report.json").read_text())["relative_error_by_space"]
        for space in spaces.values():
            self.assertIn(f"{100 * space['total']:.2g} %", done.stdout)
        self.assertIn(f" {spaces['outside']['patches']} ", done.stdout)
        done = self.run_tool("solve", "office.toml", "--patches", 300, "--error-bars", "--json", "report.json",
                             "--focus", "room.inside")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        report = json.loads((self.folder / "report.json").read_text())
        self.assertAlmostEqual(report["relative_error"]["total"], spaces["inside"]["total"], 9)
        self.assertIsNone(report["relative_error_by_space"])
        done = self.run_tool("solve", "office.toml", "--error-bars", "--json", "report.json",
                             "--focus", "house.inside")
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("house.inside", done.stderr)

    def names(self):
        return {path.name for path in self.folder.iterdir()} - {"room.obj", "room.mtl"}

    def test_values_that_are_refused(self):
        for option, values, expected in (
                ("--accuracy", ("0", "1", "100%", "-1%", "one", "", "1%%", "0.5 % %"), "1% or 0.01"),
                ("--time-limit", ("0s", "10", "-1s", "1d", "s", "", "nans"), "30s, 2min")):
            for value in values:
                done = self.solve("-o", "a.vtp", option, value, code=USAGE)
                self.assertIn(f"{option}: found '{value}'", done.stderr)
                self.assertIn(expected, done.stderr)
        for value, meant in (("1", "1%"), ("2.5", "2.5%")):
            self.assertIn(f" {meant}?", self.solve("-o", "a.vtp", "--accuracy", value, code=USAGE).stderr)
        self.assertNotIn("mean", self.solve("-o", "a.vtp", "--accuracy", "200", code=USAGE).stderr)
        self.assertEqual(self.names(), set())

    def test_what_was_understood_is_said_first(self):
        done = self.solve("-o", "a.ply", "--accuracy", "0.5", "--patches", "100")
        self.assertRegex(done.stderr, r"\Apatchlight: note: refining .* 50 %\n")
        self.assertEqual(self.solve("-o", "a.ply", "--accuracy", "0.5", "--patches", "100", "-q").stderr, "")

    def test_each_mesh_is_told_as_soon_as_it_is_solved(self):
        report, done = self.report("--accuracy", "2%", "--patches", "100")
        told = re.findall(r"^patchlight: mesh (\d+): (\d+) patches, (\S+) % \(mesh (\S+), form factors (\S+), solver \S+\), "
                          r"(\S+) s$", done.stderr, re.MULTILINE)
        self.assertGreater(len(told), 1)
        self.assertEqual([int(line[0]) for line in told], list(range(1, len(report["accuracy"]) + 1)))
        for line, mesh in zip(told, report["accuracy"]):
            self.assertEqual(int(line[1]), mesh["patches"])
            for text, error in zip(line[2:5], (mesh["total"], mesh["mesh"], mesh["form_factor"])):
                self.assertAlmostEqual(float(text), 100 * error, delta=0.06 * 100 * error)
        seconds = [float(line[5]) for line in told]
        self.assertEqual(seconds, sorted(seconds))
        one_mesh = self.solve("-o", "a.ply", "--patches", "100", "--error-bars")
        self.assertNotIn("patchlight: mesh", one_mesh.stderr)

    def test_light_that_comes_with_rows_of_rays_is_no_stage_of_its_own(self):
        self.write("office.toml", OFFICE)
        self.write("office.obj", OFFICE_MODEL)
        self.write("office.mtl", OFFICE_MATERIALS)
        for storage in ("pairs", "rays"):
            done = self.run_tool("solve", "office.toml", "--patches", 300, "--method", storage, "--json", "report.json")
            self.assertEqual(done.returncode, GOOD, done.stderr)
            costs = json.loads((self.folder / "report.json").read_text())["costs"]
            self.assertEqual("direct light" in [cost["stage"] for cost in costs], storage == "pairs", costs)

    def test_rays_are_told_with_those_that_are_doubled(self):
        report, done = self.report("--method", "rays", "--rays", "16", "--accuracy", "2%", "--patches", "300", "-v")
        rays = report["accuracy"][-1]["samples"]
        self.assertGreater(rays, 16)
        self.assertIn(f" {rays} rays", done.stdout)

    def test_without_bars_it_is_said_what_is_not_known(self):
        for words, how in ((("--no-error-bars",), "hint: --error-bars"), (("--no-closure",), "--no-closure")):
            report, done = self.report("--patches", "100", *words)
            self.assertIsNone(report["relative_error"])
            self.assertIn(how, done.stdout)
        for words in ((), ("--error-bars",)):
            report, done = self.report("--patches", "100", *words)
            self.assertGreater(report["relative_error"]["total"], 0)
            self.assertNotIn("hint: --error-bars", done.stdout)

    def test_options_that_leave_no_error_bars_are_refused(self):
        for asked in (("--accuracy", "1%"), ("--time-limit", "1s"), ("--error-bars",)):
            for other in (("--method", "on-demand", "--solver", "progressive"), ("--form-factors", "room.ff"), ("--no-closure",),
                          ("--estimator", "area"), ("--solver", "progressive", "--max-rows", "5%")):
                done = self.solve("-o", "a.vtp", *asked, *other, code=USAGE)
                self.assertIn(asked[0], done.stderr)
                self.assertIn(other[-2] if other[-1] == "5%" else other[0], done.stderr)
        self.assertIn("--focus", self.solve("-o", "a.vtp", "--focus", "white", code=USAGE).stderr)
        done = self.run_tool("relight", "room.ff", "-o", "a.vtp", "--accuracy", "1%")
        self.assertEqual((done.returncode, "unknown option --accuracy" in done.stderr), (USAGE, True), done.stderr)
        self.assertEqual(self.names(), set())

    def test_an_unknown_interest_names_the_known_ones(self):
        done = self.solve("-o", "a.vtp", "--accuracy", "5%", "--focus", "white", "--focus", "whyte", code=INPUT)
        self.assertIn("'whyte'", done.stderr)
        self.assertIn(" 'white'?", done.stderr)
        self.assertEqual(self.names(), set())

    def test_error_bars_are_stated_everywhere(self):
        report, done = self.report("--patches", 400, "--error-bars", "-o", "a.vtp")
        errors = report["relative_error"]
        self.assertEqual(set(errors), {*BARS, "inside"})
        self.assertIs(errors["inside"], False)
        # Each part may have another worst band; the total of a single band is at most the hypotenuse of all parts.
        parts = [errors[bar] for bar in BARS[:3]]
        self.assertLessEqual(errors["total"], math.hypot(*parts) * (1 + 1e-12))
        self.assertGreaterEqual(errors["total"], max(parts) * (1 - 1e-12))
        self.assertEqual(len(report["accuracy"]), 1)
        self.assertEqual(report["accuracy"][0]["patches"], report["mesh"]["patches"])
        line = next(line for line in done.stdout.splitlines() if line.startswith("estimated error"))
        shown = [float(number) for number in re.findall(r"\d[\d.]*(?:e-\d+)?", line)]
        for number, bar in zip(shown, ("total", "mesh", "form_factor", "solver", "display"), strict=True):
            # Half of the last digit: that of the solver has one, the others have two.
            last = 10 ** (math.floor(math.log10(100 * errors[bar])) - (0 if bar == "solver" else 1))
            self.assertAlmostEqual(number, 100 * errors[bar], delta=0.5001 * last, msg=bar)
        self.assertIn("error_bars", [cost["stage"].replace(" ", "_") for cost in report["costs"]])
        written = (self.folder / "a.vtp").read_bytes()
        for array in ARRAYS + ("error_solver",):
            self.assertIn(f'Name="{array}"'.encode(), written)
            self.assertIn(f'Name="unit_{array}"'.encode(), written)

    def test_without_them_nothing_is_stated(self):
        report, done = self.report("--patches", 200, "--no-error-bars", "-o", "a.vtp")
        self.assertEqual((report["relative_error"], report["accuracy"]), (None, []))
        self.assertNotIn("estimated error", done.stdout)
        written = (self.folder / "a.vtp").read_bytes()
        for array in ARRAYS:
            self.assertNotIn(f'Name="{array}"'.encode(), written)

    def test_percent_and_share_are_the_same_and_the_accuracy_is_met(self):
        for number, accuracy in enumerate(("0.5%", "0.005")):
            report, done = self.report("--accuracy", accuracy, "-v", "-o", f"{number}.ply")
            steps = report["accuracy"]
            self.assertEqual((report["request"]["accuracy"], report["request"]["patches"]), (0.005, None))
            self.assertLessEqual(steps[-1]["total"], 0.005)
            # The solver accepts a tenth below the requested error.
            self.assertTrue(all(step["total"] > 0.9 * 0.005 for step in steps[:-1]))
            self.assertEqual(steps[-1]["patches"], report["mesh"]["patches"])
            self.assertEqual({bar: steps[-1][bar] for bar in BARS} | {"inside": False}, report["relative_error"])
            self.assertGreater(len(steps), 1)
            # One row for each mesh, with separate columns.
            rows = [re.split(r"  +", line.strip()) for line in done.stdout.splitlines()]
            first = rows.index(next(row for row in rows if row[0] == "patches"))
            table = rows[first + 1:first + 1 + len(steps)]
            self.assertEqual([int(row[0]) for row in table], [step["patches"] for step in steps])
            self.assertEqual([int(row[1]) for row in table], [step["new_patches"] for step in steps])
        self.assertEqual(self.body("0.ply"), self.body("1.ply"))

    def test_any_number_of_threads_gives_the_same_bytes(self):
        for threads in (1, 2):
            self.solve("--accuracy", "0.5%", "--threads", threads, "-o", f"{threads}.ply")
        self.assertEqual(self.body("1.ply"), self.body("2.ply"))

    def test_refined_meshes_have_no_holes(self):
        """Areas add up to those of the polygons, even if a corner hangs in the middle of a neighbor's edge."""
        report, _ = self.report("--accuracy", "0.5%", "--sides", "both", "-o", "a.ply")
        faces = faces_of((self.folder / "a.ply").read_bytes())
        self.assertEqual(len(faces), report["mesh"]["patches"])
        areas = [area_of(face) for face in faces]
        both = 2 * (6 * 4 + 1 + 0.25)
        # Corners are doubles of about 2 m, so each area is exact to 1e-15.
        self.assertAlmostEqual(math.fsum(areas), both, delta=1e-15 * len(faces) * both)
        # A hanging corner is the middle of an edge.
        corners = {corner for face in faces for corner in face}
        middles = {tuple((x + y) / 2 for x, y in zip(a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1])}
        self.assertGreater(len(corners & middles), 0)

    def test_interest_saves_patches(self):
        self.write("room.obj", ROOM.replace("f 13 14 15 16", "o plate\nf 13 14 15 16"))
        everything, _ = self.report("--accuracy", "0.5%")
        plate, _ = self.report("--accuracy", "0.5%", "--focus", "plate")
        self.assertEqual(plate["request"]["interest"], ["plate"])
        self.assertLessEqual(plate["relative_error"]["total"], 0.005)
        self.assertLess(plate["mesh"]["patches"], everything["mesh"]["patches"])

    def test_time_ends_with_a_result(self):
        begin = time.monotonic()
        report, _ = self.report("--time-limit", "1.5s", "-o", "a.vtp")
        # Not a measure of speed: the run must only come to an end.
        self.assertLess(time.monotonic() - begin, 100)
        self.assertEqual(report["request"]["time_s"], 1.5)
        self.assertGreater(report["relative_error"]["total"], 0)
        self.assertIn("a.vtp", self.names())

    def test_an_accuracy_not_reached_in_time_is_exit_code_3_with_the_result(self):
        report, done = self.report("--accuracy", "0.001%", "--time-limit", "1s", "-o", "a.vtp", code=NOT_REACHED)
        self.assertTrue(report["solution"]["converged"])
        self.assertGreater(report["relative_error"]["total"], 1e-5)
        found = re.search(r"warning: accuracy of 0.001 % NOT reached: the error is about (\S+) % after \S+ s, mainly "
                          r"from the (size of the patches|sampling of form factors)\nhint: a longer --time-limit", done.stderr)
        self.assertIsNotNone(found, done.stderr)
        self.assertAlmostEqual(float(found[1]) / 100 / report["relative_error"]["total"], 1, delta=0.05)
        self.assertIn("a.vtp", self.names())

    def test_what_is_not_solved_states_no_error(self):
        done = self.solve("--set", "white.reflectance=1", "--set", "lamp.reflectance=1", "--error-bars", "--patches", 200,
                          "-o", "a.vtp", code=NOT_REACHED)
        self.assertIn("warning: not solved", done.stderr)
        self.assertNotIn("estimated error", done.stdout)

    def test_an_accuracy_out_of_memory_is_exit_code_4_with_what_can_be_had(self):
        done = self.solve("--accuracy", "0.05%", "--method", "pairs", "--memory", "80MB", "-o", "a.vtp", code=MEMORY)
        found = re.search(r"--accuracy 0.05% needs about (\d+) patches and (\S+) GB, and 0.08 GB is "
                          r"allowed\nhint: --accuracy (\S+)% or more", done.stderr)
        self.assertIsNotNone(found, done.stderr)
        self.assertGreater(int(found[1]), 600)
        self.assertGreater(float(found[2]), 0.08)
        self.assertGreater(float(found[3]), 0.05)
        self.assertEqual(self.names(), set())

    def test_a_series_is_of_the_last_mesh(self):
        report, _ = self.report("--accuracy", "0.5%", "--series", "a.pvd")
        self.assertGreater(len(report["accuracy"]), 1)
        frames = re.findall(r"<DataSet ", (self.folder / "a.pvd").read_text())
        self.assertEqual(len(frames), len(report["solution"]["iterations"]))


if __name__ == "__main__":
    unittest.main()
