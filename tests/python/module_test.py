"""The module for Python: the same results as the tool, arrays without copies, operators, solvers, derivatives, errors.

usage: module_test.py TOOL MESHES, with the module's folder in PYTHONPATH. Ends with 77 where numpy or scipy is missing.
"""
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zlib

try:
    import numpy
    import scipy.sparse.linalg
except ImportError as missing:
    print(f"left out: {missing}")
    sys.exit(77)

import patchlight as pl

TOOL, MESHES = sys.argv[1], pathlib.Path(sys.argv[2])
BOX = MESHES / "cornell_box.obj"


class ModuleTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = pl.read(BOX)
        cls.solved = pl.solve(cls.scene, patches=400, no_error_bars=True)
        cls.transport = pl.transport(cls.scene, patches=400)

    def test_has_the_bits_of_the_tool(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            subprocess.run([TOOL, "solve", BOX, "--patches", "400", "--no-error-bars", "-q", "-o", folder / "tool.ply", "--json", folder / "tool.json"], check=True)
            self.solved.write(str(folder / "module.ply"))
            written, own = ((folder / f"{who}.ply").read_bytes().partition(b"end_header\n")[2] for who in ("tool", "module"))
            self.assertEqual(written, own)
            report = json.loads((folder / "tool.json").read_text())
        self.assertEqual(report["energy_balance"], self.solved.report()["energy_balance"])
        self.assertEqual(report["materials"], self.solved.report()["materials"])

    def test_a_scene_shows_itself_and_its_materials_have_names(self):
        scene = pl.read(BOX)
        self.assertIn("23 polygons; materials white, red, green, light", repr(scene))
        scene.materials["red"].reflectance = 0.3
        self.assertEqual(list(scene.materials[1].reflectance), [0.3, 0.3, 0.3])
        with self.assertRaisesRegex(KeyError, "'whit'.*white, red, green, light"):
            scene.materials["whit"]

    def test_arrays_are_the_solvers_own_memory(self):
        irradiance = self.solved.irradiance
        self.assertEqual(irradiance.__array_interface__["data"][0], self.solved.irradiance_address)
        self.assertFalse(irradiance.flags["OWNDATA"])
        self.assertFalse(irradiance.flags["WRITEABLE"])
        self.assertEqual(irradiance.shape, (self.solved.size, 3))

    def test_arrays_outlive_the_simulation(self):
        solved = pl.solve(self.scene, patches=60)
        radiosity, sum_then = solved.radiosity, solved.radiosity.sum()
        del solved
        self.assertEqual(radiosity.sum(), sum_then)

    def test_a_stated_reflectance_takes_the_place_of_a_picture(self):
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            pixels = b"\0" + bytes([255, 0, 0]) + bytes([0, 0, 255])
            (folder / "two.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 1, 8, 2, 0, 0, 0)) +
                                             chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))
            (folder / "a.mtl").write_text("newmtl floor\nKd .5 .5 .5\nmap_Kd two.png\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n")
            (folder / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                          "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl floor\nf 1/1 2/2 3/3 4/4\nusemtl lamp\nf 8 7 6 5\n")
            scene = pl.read(folder / "a.obj")
        floor = next(material for material in scene.materials if material.name == "floor")
        on_floor = lambda solved: solved.reflectance[solved.exitance.sum(axis=1) == 0]
        self.assertGreater(numpy.ptp(on_floor(pl.solve(scene, patches=100)), axis=0).max(), 0.1)
        floor.reflectance = 0.25
        self.assertTrue((on_floor(pl.solve(scene, patches=100)) == 0.25).all())

    def test_what_is_lent_to_a_solver_ends_with_it(self):
        kept = []

        def solver(apply, exitance, reflectance, direct):
            kept.append(apply)
            return apply(exitance)

        pl.solve(self.scene, own=solver, patches=60)
        with self.assertRaisesRegex(pl.InputError, "after the solver"):
            kept[0](numpy.zeros((60, 3)))

    def test_arrays_fit_the_equations(self):
        s = self.solved
        numpy.testing.assert_allclose(s.radiosity, s.exitance + s.reflectance * s.irradiance, rtol=1e-14)
        self.assertEqual(s.corners.shape, (s.size, 4))
        self.assertLess(s.corners.max(), len(s.vertices))
        # 179 lm/W, Rec. 709
        numpy.testing.assert_allclose(s.illuminance, s.irradiance @ (179 * numpy.array([0.2126, 0.7152, 0.0722])), rtol=2e-4)

    def test_cells_cover_the_area(self):
        cells = self.solved.cells()
        areas = []
        for begin, end in zip(cells["offsets"], cells["offsets"][1:]):
            ring = cells["points"][cells["connectivity"][begin:end]]
            areas.append(numpy.linalg.norm(numpy.cross(ring, numpy.roll(ring, -1, axis=0)).sum(axis=0)) / 2)
        numpy.testing.assert_allclose(areas, self.solved.area, rtol=1e-9)

    def test_materials_may_be_changed(self):
        scene = self.scene.copy()
        lamp = next(material for material in scene.materials if max(material.exitance) > 0)
        lamp.exitance = [2 * value for value in lamp.exitance]
        doubled = pl.solve(scene, patches=400, no_error_bars=True)
        numpy.testing.assert_allclose(doubled.irradiance, 2 * self.solved.irradiance, rtol=1e-5)
        white = next(material for material in scene.materials if material.name == "white")
        white.reflectance = 0.5
        self.assertEqual(list(white.reflectance), [0.5] * 3)
        with self.assertRaises(pl.InputError):
            white.reflectance = [0.5, 0.5]

    def test_operator_is_h_equals_f_b(self):
        t = self.transport
        F = t.form_factors((0, t.size), (0, t.size))
        B = numpy.random.default_rng(1).random((t.size, 3))
        # Only apply() includes the part of a row that is lost by storing floats, below 3e-7 of the row.
        numpy.testing.assert_allclose(t.apply(B), F @ B, rtol=1e-6)
        operator = t.operator
        numpy.testing.assert_array_equal(operator @ B, t.apply(B))
        numpy.testing.assert_allclose(operator.rmatvec(B[:, 0]), F.T @ B[:, 0], rtol=1e-6)
        # scipy's own solver gives the same solution of (1 - rho F) B = E.
        rho, E = t.reflectance[:, 0], t.exitance[:, 0]
        system = scipy.sparse.linalg.LinearOperator((t.size, t.size), matvec=lambda x: x - rho * (operator @ x))
        found, fault = scipy.sparse.linalg.gmres(system, E, tol=1e-10, atol=0)
        self.assertEqual(fault, 0)
        numpy.testing.assert_allclose(found, t.solve("cg", tolerance=1e-10).radiosity[:, 0], atol=1e-8 * E.max())

    def test_every_solver_tells_its_history(self):
        reference = self.transport.solve("cg", tolerance=1e-10).radiosity
        self.assertEqual(len(pl.solvers), 11)
        for name in pl.solvers:
            solution = self.transport.solve(name, tolerance=1e-6)
            self.assertTrue(solution.converged, name)
            self.assertGreater(len(solution.history), 1)
            self.assertLessEqual(solution.history[-1]["error_bound"], 1e-6)
            numpy.testing.assert_allclose(solution.radiosity, reference, atol=1e-5 * reference.max())

    def test_own_jacobi_in_ten_lines_is_ours(self):
        def jacobi(apply, E, rho, H_direct):
            H = numpy.zeros_like(E)
            for _ in range(40):
                H = apply(E + rho * H) + H_direct
            return H

        own = pl.solve(self.scene, patches=400, own=jacobi, no_error_bars=True)
        ours = self.transport.solve("jacobi", tolerance=1e-12, max_iterations=40)
        self.assertEqual(ours.history[-1]["iteration"], 40)
        # The same form factors, with sums over bands together or one by one: rounding alone.
        numpy.testing.assert_allclose(own.irradiance, ours.irradiance, rtol=1e-9)
        numpy.testing.assert_allclose(own.irradiance, self.solved.irradiance, rtol=1e-4)

    def test_sensitivities_are_those_of_differences(self):
        t = self.transport
        weights = numpy.where(t.centroid[:, 1] < 1e-3, t.area, 0)
        weights = weights / weights.sum()
        found = pl.sensitivities(t, weights)
        step = 1e-4
        for k, material in enumerate(self.scene.materials):
            for quantity in ("reflectance", "exitance"):
                values = []
                for sign in (1, -1):
                    scene = self.scene.copy()
                    changed = list(getattr(material, quantity))
                    changed[1] += sign * step
                    setattr(scene.materials[k], quantity, changed)
                    values.append(self.value_of(t, scene, weights))
                difference = (values[0] - values[1]) / (2 * step)
                self.assertAlmostEqual(found[quantity][k, 1], difference, delta=1e-4 * abs(difference))

    def test_sensitivities_of_sensors_are_those_of_differences(self):
        with tempfile.TemporaryDirectory() as name:
            points = pathlib.Path(name) / "desk.txt"
            points.write_text("0.51 0.1 0.3 0 1 0\n0.28 0.3 0.05 0 0 1\n")
            scene = pl.read(BOX, points=points)
        t = pl.transport(scene, patches=400)
        read = pl.solve(scene, patches=400, no_error_bars=True).sensors()
        G = t.sensor_factors()
        step = 1e-4
        for k, found in enumerate(pl.sensor_sensitivities(t)):
            # Sensor readings are sampled with rays that follow the light, here for constant patches, there for linear
            # ones. The limit is six standard errors, of both.
            numpy.testing.assert_array_less(abs(found["value"] - read["irradiance"][k]), 6 * numpy.sqrt(2) * read["standard_error"][k] + 1e-12)
            for m in range(len(scene.materials)):
                for quantity in ("reflectance", "exitance"):
                    values = []
                    for sign in (1, -1):
                        changed = scene.copy()
                        spectrum = list(getattr(scene.materials[m], quantity))
                        spectrum[0] += sign * step
                        setattr(changed.materials[m], quantity, spectrum)
                        values.append(G[k] @ self.radiosity_of(t, changed)[:, 0])
                    difference = (values[0] - values[1]) / (2 * step)
                    self.assertAlmostEqual(found[quantity][m, 0], difference, delta=1e-4 * abs(difference))

    def value_of(self, transport, scene, weights):
        """The mean irradiance with the materials of a scene."""
        B = self.radiosity_of(transport, scene)
        return (weights[:, None] * transport.apply(B)).sum(axis=0)[1]

    def radiosity_of(self, transport, scene):
        """The radiosity with the materials of a scene, by fixed-point iteration instead of a patchlight solver."""
        rho = numpy.array([list(material.reflectance) for material in scene.materials])[transport.material]
        before = numpy.array([list(material.exitance) for material in self.scene.materials])[transport.material]
        now = numpy.array([list(material.exitance) for material in scene.materials])[transport.material]
        E = transport.exitance + numpy.where(transport.front[:, None] == 0, now - before, 0)
        B = E
        for _ in range(100):
            B = E + rho * transport.apply(B)
        return B

    def test_errors_have_the_words_of_the_tool(self):
        said = subprocess.run([TOOL, "solve", BOX, "--patches", "-3", "-o", "x.ply"], capture_output=True, text=True, check=False).stderr
        with self.assertRaises(pl.InputError) as caught:
            pl.solve(self.scene, patches=-3)
        self.assertIn(str(caught.exception), said)
        with self.assertRaises(pl.InputError) as caught:
            pl.solve(self.scene, pacthes=3)
        self.assertIn(" --patches?", str(caught.exception))
        with self.assertRaises(ValueError):
            pl.read("nowhere.obj")

    def test_threads_run_meanwhile_and_progress_is_told(self):
        stages = []
        counted = [0]
        ended = threading.Event()

        def count():
            while not ended.is_set():
                counted[0] += 1
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        pl.solve(self.scene, patches=1500, progress=lambda stage, share: stages.append(stage))
        ended.set()
        other.join()
        self.assertGreater(counted[0], 20)
        self.assertIn("form factors", " ".join(stages))

    def test_ctrl_c_ends_the_work(self):
        timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            pl.solve(self.scene, patches=20000)
        self.assertLess(time.monotonic() - begin, 10)

    def test_ctrl_c_ends_a_solver_of_ones_own(self):
        asked = []

        def endless(apply, exitance, reflectance, direct):
            os.kill(os.getpid(), signal.SIGINT)
            while not asked:
                apply(exitance)

        # A run that ignores Ctrl-C fails and does not hang.
        guard = threading.Timer(20, lambda: asked.append(True))
        guard.start()
        before = signal.getsignal(signal.SIGINT)
        with self.assertRaises(KeyboardInterrupt):
            pl.solve(self.scene, own=endless, patches=60, no_error_bars=True)
        guard.cancel()
        self.assertEqual(asked, [])
        # The module restores Python's signal handlers, and the next run works.
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        with self.assertRaises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
            time.sleep(1)
        again = pl.solve(self.scene, patches=400, no_error_bars=True)
        numpy.testing.assert_array_equal(again.irradiance, self.solved.irradiance)

    def test_a_page_tells_what_its_command_does_not(self):
        def data_of(solved):
            return json.loads(re.search(r'id="data">(.*?)</script>', solved.page().decode(), re.DOTALL)[1])

        plain = data_of(pl.solve(BOX, unit="cm", patches=60))
        self.assertEqual(plain["changes"], [])
        self.assertEqual(plain["command_line"], f"patchlight solve {BOX} --unit cm --patches 60")
        scene = pl.read(BOX).copy()
        scene.materials["red"].reflectance = [0.25, 0.5, 0.75]
        scene.materials["light"].exitance = 3

        def nothing(apply, exitance, reflectance, direct):
            return apply(exitance)

        changed = data_of(pl.solve(scene, own=nothing, patches=60))
        self.assertEqual(changed["changes"], ["red.reflectance was set to 0.25, 0.5, 0.75", "light.exitance was set to 3, 3, 3",
                                              "solved by nothing() in place of the solver"])

    def test_a_scene_that_is_read_takes_no_options_of_reading(self):
        with self.assertRaisesRegex(pl.InputError, r"\bsky\b.*pl\.read\(FILE, sky=...\)"):
            pl.solve(self.scene, sky="overcast:10000lx")
        in_centimetres = pl.solve(BOX, unit="cm", patches=60).area.sum()
        self.assertAlmostEqual(in_centimetres / pl.solve(BOX, unit="m", patches=60).area.sum(), 1e-4, 9)

    def test_an_option_that_a_call_does_not_use_is_refused(self):
        for name, value in (("html", "a.html"), ("output", "a.vtp"), ("form_factors", "a.ff"), ("picture", "a.png")):
            with self.assertRaisesRegex(pl.InputError, f"^{name}: "):
                pl.solve(self.scene, patches=60, **{name: value})
        with self.assertRaisesRegex(pl.InputError, "tolerance"):
            pl.transport(self.scene, patches=60, tolerance=0.1)
        with self.assertRaisesRegex(pl.InputError, "solver"):
            pl.solve(self.scene, own=lambda apply, E, rho, direct: direct, patches=60, solver="cg")

    def test_a_solution_that_has_not_converged_is_warned_of(self):
        with self.assertWarnsRegex(UserWarning, "converge"):
            cut = pl.solve(self.scene, patches=60, solver="jacobi", max_iterations=1, no_error_bars=True)
        self.assertFalse(cut.converged)
        self.assertTrue(self.solved.converged)
        self.assertIsInstance(self.solved.notes, list)

    def test_plan_page_picture_and_docs(self):
        self.assertIn("occlusion", [decision["effect"] for decision in pl.plan(self.scene, patches=400)["decisions"]])
        page = self.solved.page().decode()
        self.assertTrue(page.startswith("<!doctype html>"))
        self.assertIn("<iframe", self.solved._repr_html_())
        picture = self.solved.picture(size="40x30")
        self.assertEqual(picture["srgb"].shape, (30, 40, 3))
        self.assertEqual(picture["radiance"].shape, (30, 40, 3))
        self.assertIn("--max-edge LENGTH", pl.solve.__doc__)
        self.assertEqual(pl.check(self.scene), self.scene.problems)

    def test_sensors_are_read(self):
        with tempfile.TemporaryDirectory() as name:
            points = pathlib.Path(name) / "desk.txt"
            points.write_text("0.28 0.05 0.1 0 1 0\n")
            read = pl.solve(pl.read(BOX, points=points), patches=400).sensors()
        self.assertEqual(read["irradiance"].shape, (1, 3))
        self.assertGreater(read["value"][0], 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
