"""patchlight annual: a year in a small room, its arrays and tables."""
import ast
import csv
import json
import math
import pathlib
import struct
import unittest

from support import ToolTest, is_one_message

DAYS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)
# A room of 3 x 4 x 2.7 m without its wall to the south.
ROOM = """usemtl wall
v 0 0 0
v 3 0 0
v 3 4 0
v 0 4 0
v 0 0 2.7
v 3 0 2.7
v 3 4 2.7
v 0 4 2.7
f 1 2 3 4
f 8 7 6 5
f 3 7 8 4
f 2 6 7 3
f 4 8 5 1
"""
SENSORS = "1.5 0.5 0.8 0 0 1\n1.5 2 0.8 0 0 1\n1.5 3.7 0.8 0 0 1\n"


def weather(place="LOCATION,Somewhere,-,XXX,TMY,000000,47,8,1.0,400", spoil=None):
    """A year whose sun and sky follow the hour of the day alone."""
    lines = [place, "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31"]
    for month, days in enumerate(DAYS, 1):
        for day in range(1, days + 1):
            for hour in range(1, 25):
                height = max(0.0, math.sin((hour - 6.5) / 12 * math.pi))
                lines.append(f"2001,{month},{day},{hour},60,?9,11,1,50,82000,0,0,300,0,{600 * height:.0f},{150 * height:.0f},0,0")
    if spoil:
        spoil(lines)
    return "\n".join(lines) + "\n"


def read_npy(path):
    """Shape and values of a file of 32-bit floats."""
    raw = path.read_bytes()
    length = struct.unpack("<H", raw[8:10])[0]
    head = ast.literal_eval(raw[10:10 + length].decode("latin-1"))
    values = struct.unpack(f"<{(len(raw) - 10 - length) // 4}f", raw[10 + length:])
    return head["shape"], values


class AnnualTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("open.obj", ROOM)
        self.write("desk.pts", SENSORS)
        self.write("city.epw", weather())

    def annual(self, *words):
        return self.run_tool("annual", "open.obj", "--up", "z", "--points", "desk.pts", "--patches", 200, "-o", "year", *words)

    def test_a_year_in_a_room(self):
        done = self.annual("--weather", "city.epw", "--sky-division", 1)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("sDA300/50", done.stdout)
        shape, values = read_npy(self.folder / "year" / "illuminance.npy")
        self.assertEqual(shape, (8760, 3))
        of_sun = read_npy(self.folder / "year" / "sunlight.npy")[1]
        self.assertTrue(all(0 <= s <= e * 1.0001 for s, e in zip(of_sun, values)))
        self.assertEqual(values[:9], (0,) * 9)  # at night
        noon = values[(171 * 24 + 12) * 3:][:3]
        self.assertTrue(noon[0] > noon[1] > noon[2] > 50, noon)

        # The same by an hour alone.
        done = self.run_tool("solve", "open.obj", "--up", "z", "--points", "desk.pts", "--patches", 200, "--weather",
                             "city.epw@6-21-12", "--points-output", "hour.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("city.epw:", "month 6, day 21", "altitude 6", "Perez sky"):
            self.assertIn(word, done.stdout + done.stderr)
        with open(self.folder / "hour.csv", newline="", encoding="utf-8") as file:
            for row, value in zip(csv.DictReader(file), noon):
                lux, error = float(row["E_v_lx"]), float(row["SE_v_lx"])
                self.assertLessEqual(abs(value - lux), 0.01 * lux + 3 * error)

        # Tables and text have the same values.
        lines = (self.folder / "year" / "illuminance.ill").read_text().splitlines()
        self.assertEqual(len(lines), 8760)
        words = lines[171 * 24 + 12].split()
        self.assertEqual(words[:3], ["6", "21", "12.5"])
        for word, value in zip(words[3:], noon):
            self.assertLessEqual(abs(float(word) - value), 1e-4 * value)
        facts = json.loads((self.folder / "year" / "annual.json").read_text())
        self.assertEqual(facts["occupied"]["hours"], 3650)
        occupied = [k for k in range(8760) if 8 <= k % 24 < 18]
        autonomy = [100 * sum(values[3 * k + i] >= 300 for k in occupied) / 3650 for i in range(3)]
        with open(self.folder / "year" / "sensors.csv", newline="", encoding="utf-8") as file:
            for row, expected in zip(csv.DictReader(file), autonomy):
                self.assertAlmostEqual(float(row["DA300_percent"]), expected, places=5)
        share = 100 * sum(value >= 50 for value in autonomy) / 3
        self.assertAlmostEqual(facts["building"]["sDA300_50_percent"]["value"], share, places=5)
        with open(self.folder / "year" / "hours.csv", newline="", encoding="utf-8") as file:
            hours = list(csv.DictReader(file))
        self.assertEqual(len(hours), 8760)
        self.assertGreater(float(hours[171 * 24 + 12]["sun_altitude_deg"]), 60)

        # The reference page has all files and columns.
        page = (pathlib.Path(__file__).parents[2] / "docs/reference/outputs/annual-folder.md").read_text(encoding="utf-8")
        for file in (self.folder / "year").iterdir():
            self.assertIn(f"`{file.name}`", page)
        for table in ("sensors.csv", "rooms.csv"):
            columns = (self.folder / "year" / table).read_text().splitlines()[0].split(",")
            for column in columns:
                if f"SE_{column}" in columns:
                    self.assertIn(f"`{column}`", page)

        # A year replaces an earlier one, and no other folder.
        self.assertEqual(self.annual("--weather", "city.epw", "--sky-division", 1, "-q").returncode, 0)
        (self.folder / "year" / "mine.txt").write_text("mine")
        self.assertEqual(self.annual("--weather", "city.epw").returncode, 6)

    def test_the_sun_follows_the_vertical_axis(self):
        # Axis y up instead of z, north -z instead of y: the same room, with the same sunlight.
        def turned(text, places):
            rows = []
            for line in text.splitlines():
                words = line.split()
                for at in places(words):
                    words[at + 1], words[at + 2] = words[at + 2], f"{-float(words[at + 1]):g}"
                rows.append(" ".join(words))
            return "\n".join(rows) + "\n"
        self.write("turned.obj", turned(ROOM, lambda words: [1] if words[0] == "v" else []))
        self.write("turned.pts", turned(SENSORS, lambda words: [0, 3]))
        light = []
        for model, axis, points in (("open.obj", "z", "desk.pts"), ("turned.obj", "y", "turned.pts")):
            done = self.run_tool("annual", model, "--up", axis, "--points", points, "--patches", 100, "--weather", "city.epw",
                                 "--sky-division", 1, "-q", "-o", f"year_{axis}")
            self.assertEqual(done.returncode, 0, done.stderr)
            light.append(read_npy(self.folder / f"year_{axis}" / "sunlight.npy")[1])
        self.assertGreater(max(light[0]), 1000)
        for one, other in zip(*light):
            self.assertLessEqual(abs(one - other), 1e-3 * one)

    def test_refusals(self):
        def remove_an_hour(lines):
            del lines[1000]
        self.write("short.epw", weather(spoil=remove_an_hour))
        for words, code, parts in (((), 2, ["--weather"]),
                                   (("--weather", "none.epw"), 2, ["none.epw"]),
                                   (("--weather", "short.epw"), 2, ["short.epw:1001", "expected"]),
                                   (("--weather", "city.epw", "--hours", "18-8"), 1, ["--hours", "8-18"]),
                                   (("--weather", "city.epw", "--sky-division", 3), 1, ["--sky-division"]),
                                   (("--weather", "city.epw", "--memory", "100kB"), 4, ["sensors"])):
            done = self.annual(*words)
            self.assertEqual(done.returncode, code, done.stderr)
            for part in parts:
                self.assertIn(part, done.stderr)
            self.assertFalse((self.folder / "year").exists())
        done = self.run_tool("annual", "open.obj", "--up", "z", "--weather", "city.epw", "-o", "year")
        self.assertEqual(done.returncode, 2)
        self.assertIn("sensors", done.stderr)
        self.assertTrue(is_one_message("\n".join(done.stderr.splitlines()[-2:])))


if __name__ == "__main__":
    unittest.main()
