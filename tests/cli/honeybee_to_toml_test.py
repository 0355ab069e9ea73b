"""scripts/honeybee_to_toml.py: geometry with holes for windows, grids, views; what comes out is solved, and drawn
by scripts/sensor_map.py."""
import csv
import json
import pathlib
import subprocess
import sys
import unittest

from support import ToolTest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "honeybee_to_toml.py"


def face(name, kind, boundary, apertures=()):
    return {"type": "Face", "identifier": name, "face_type": kind, "geometry": {"boundary": boundary},
            "boundary_condition": {"type": "Outdoors"}, "apertures": list(apertures)}


def window(name, x):
    """A pane of 1 x 1.5 m with a shade above it."""
    boundary = [[x, 0, 1], [x + 1, 0, 1], [x + 1, 0, 2.5], [x, 0, 2.5]]
    shade = [[x, 0, 2.6], [x + 1, 0, 2.6], [x + 1, -0.3, 2.6], [x, -0.3, 2.6]]
    return {"type": "Aperture", "identifier": name, "geometry": {"boundary": boundary},
            "boundary_condition": {"type": "Outdoors"},
            "outdoor_shades": [{"identifier": name + "_shade", "geometry": {"boundary": shade}}]}


def building():
    """A room of 4 x 6 x 3 m; two windows of 1 x 1.5 m in the wall y = 0; faces look outward."""
    glass = [window("left", 0.5), window("right", 2.5)]
    faces = [face("floor", "Floor", [[0, 0, 0], [0, 6, 0], [4, 6, 0], [4, 0, 0]]),
             face("roof", "RoofCeiling", [[0, 0, 3], [4, 0, 3], [4, 6, 3], [0, 6, 3]]),
             face("south", "Wall", [[0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3]], glass),
             face("north", "Wall", [[4, 6, 0], [0, 6, 0], [0, 6, 3], [4, 6, 3]]),
             face("west", "Wall", [[0, 6, 0], [0, 0, 0], [0, 0, 3], [0, 6, 3]]),
             face("east", "Wall", [[4, 0, 0], [4, 6, 0], [4, 6, 3], [4, 0, 3]])]
    sensors = [{"pos": [0.5 + x, 0.5 + y, 0.8], "dir": [0, 0, 1]} for x in range(4) for y in range(6)]
    loose = [{"pos": [1, 1, 1], "dir": [1, 0, 0]}, {"pos": [1, 3, 1], "dir": [0, 0, 1]}]
    view = {"identifier": "view", "position": [2, 5, 1.5], "direction": [0, -1, 0], "v_size": 70}
    light = {"sensor_grids": [{"identifier": "plane", "sensors": sensors}, {"identifier": "loose", "sensors": loose}],
             "views": [view]}
    return {"units": "Meters", "rooms": [{"identifier": "room", "faces": faces}], "properties": {"radiance": light}}


class HoneybeeTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("model.hbjson", json.dumps(building()))
        command = [sys.executable, str(SCRIPT), "model.hbjson", "model.toml"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=600, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_model_is_sound_and_its_areas_are_right(self):
        done = self.run_tool("check", "model.toml", "--json", "check.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads((self.folder / "check.json").read_text())
        areas = {material["name"]: material["area_m2"] for material in report["materials"]}
        self.assertAlmostEqual(areas["window"], 2 * 1.5, places=12)
        self.assertAlmostEqual(areas["wall"], 2 * (4 + 6) * 3 - 3, places=12)
        self.assertAlmostEqual(areas["exterior_shade"], 2 * 0.3, places=12)
        self.assertEqual([p for p in report["problems"] if p["severity"] != "remark"], [])

    def test_daylight_falls_off_from_the_windows(self):
        done = self.run_tool("solve", "model.toml", "--patches", 600, "-o", "out.vtp", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "model.irradiance.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 26)
        plane = {(float(r["x"]), float(r["y"])): r for r in rows if r["group"] == "plane"}
        self.assertEqual(len(plane), 24)
        for x in (0.5, 1.5, 2.5, 3.5):
            line = [float(plane[x, 0.5 + y]["daylight_factor_percent"]) for y in range(6)]
            self.assertGreater(line[1], 3 * line[5])
            self.assertGreater(min(line), 0.1)
            self.assertLess(max(line), 64)  # the share that the panes let through
        command = [sys.executable, str(SCRIPT.with_name("sensor_map.py")), "model.irradiance.csv", "map.svg"]
        subprocess.run(command, cwd=self.folder, check=True, timeout=600)
        image = (self.folder / "map.svg").read_text()
        self.assertEqual(image.count('stroke="white"'), 26)  # a square for each sensor
        # Room, windows and shades are symmetric about x = 2, and so is the light, but for its sampling and the patches.
        for y in range(6):
            left, right = (float(plane[x, 0.5 + y]["E_v_lx"]) for x in (1.5, 2.5))
            self.assertAlmostEqual(left, right, delta=0.1 * right)


if __name__ == "__main__":
    unittest.main()
