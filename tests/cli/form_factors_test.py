"""patchlight form-factors: the matrix in common formats, the folder, and solving from it."""
import ast
import csv
import json
import struct
import unittest

from support import ROOM, ToolTest, content

GOOD, USAGE, INPUT, MEMORY, OUTPUT = 0, 1, 2, 4, 6


def load(file):
    """A minimal reader of .npy: shape and values."""
    data = file.read_bytes()
    assert data[:8] == b"\x93NUMPY\x01\x00"
    (length,) = struct.unpack("<H", data[8:10])
    header = ast.literal_eval(data[10 : 10 + length].decode())
    assert not header["fortran_order"]
    letter, size = {"<f4": ("f", 4), "<f8": ("d", 8), "<i4": ("i", 4), "<i8": ("q", 8)}[header["descr"]]
    values = data[10 + length :]
    return header["shape"], struct.unpack(f"<{len(values) // size}{letter}", values)


class FormFactorsTest(ToolTest):
    def find(self, *arguments, code=GOOD):
        done = self.run_tool("form-factors", "room.obj", *arguments)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def test_folder(self):
        self.find("-o", "room.ff/", "--patches", "150")
        folder = self.folder / "room.ff"
        info = json.loads((folder / "info.json").read_text())
        size = info["patches"]
        shape, F = load(folder / "F.npy")
        self.assertEqual(shape, (size, size))
        shape, area = load(folder / "area.npy")
        self.assertEqual(shape, (size,))
        for i in range(size):
            # The room is closed. The remainder that is not stored is below 1e-7, and storing F costs 1e-7.
            self.assertAlmostEqual(sum(F[i * size : (i + 1) * size]), 1, delta=1e-6)
            self.assertEqual(F[i * size + i], 0)
            for j in range(i):
                self.assertAlmostEqual(area[i] * F[i * size + j], area[j] * F[j * size + i], delta=1e-6 * area[i])
        self.assertEqual(set(info["files"]) | {"info.json"}, {path.name for path in folder.iterdir()})
        self.assertRegex(info["geometry_sha256"], "^[0-9a-f]{64}$")

    def test_rows_of_rays_sum_up_to_what_patches_see(self):
        self.find("-o", "room.ff", "--method", "rays", "--patches", "300")
        folder = self.folder / "room.ff"
        info = json.loads((folder / "info.json").read_text())
        self.assertEqual(set(info["files"]) | {"info.json"}, {path.name for path in folder.iterdir()})
        size = info["patches"]
        _, lost = load(folder / "lost_share.npy")
        for half in (0, 1):
            begin, hits, weight, entry_begin, columns, entries = (
                load(folder / f"{name}_{half}.npy")[1]
                for name in ("hit_begin", "hits", "hit_weight", "entry_begin", "entry_columns", "entries"))
            self.assertEqual((len(begin), len(weight), len(entry_begin)), (size + 1, size, size + 1))
            self.assertEqual((begin[size], entry_begin[size]), (len(hits), len(entries)))
            self.assertTrue(all(0 <= column < size for column in (*hits, *columns)))
            for i in range(size):
                total = (begin[i + 1] - begin[i]) * weight[i] + sum(entries[entry_begin[i] : entry_begin[i + 1]])
                self.assertAlmostEqual(total, 1 - lost[4 * i] - lost[4 * i + 1], delta=1e-6)

    def test_rows_of_rays_are_no_matrix(self):
        for more in (["--matrix", "npy"], ["--by", "material"]):
            with self.subTest(more[0]):
                done = self.find("-o", "room.ff", "--method", "rays", *more, code=USAGE)
                self.assertIn("--method pairs", done.stderr)
        done = self.find("-o", "F.npy", "--method", "rays", code=USAGE)
        self.assertIn("--method pairs", done.stderr)
        done = self.find("-o", "room.ff", "--method", "on-demand", code=USAGE)
        self.assertIn("pairs, rays", done.stderr)
        done = self.find("-o", "room.ff", "--method", "rays", "--no-closure", code=USAGE)
        self.assertIn("--no-closure", done.stderr)

    def test_raw_rows_are_not_closed(self):
        self.find("-o", "raw.ff", "--no-closure", "--patches", "150")
        size = json.loads((self.folder / "raw.ff/info.json").read_text())["patches"]
        _, F = load(self.folder / "raw.ff/F.npy")
        _, raw_row_sum = load(self.folder / "raw.ff/raw_row_sum.npy")
        for i in range(size):
            self.assertAlmostEqual(sum(F[i * size : (i + 1) * size]), raw_row_sum[i], delta=1e-6)
        self.assertGreater(max(abs(x - 1) for x in raw_row_sum), 1e-5)

    def test_sampling_errors_are_those_of_partly_occluded_pairs(self):
        self.find("-o", "room.ff", "--patches", "150")
        self.find("-o", "mtx.ff", "--patches", "150", "--matrix", "mtx")
        info = json.loads((self.folder / "room.ff/info.json").read_text())
        size = info["patches"]
        shape, error = load(self.folder / "room.ff/sampling_error.npy")
        self.assertEqual(shape, (size, size))
        _, area = load(self.folder / "room.ff/area.npy")
        different = sum(x != 0 for x in error)
        self.assertGreater(different, 0)
        self.assertLessEqual(different, 2 * info["counts"]["partly_occluded_pairs"])
        for i in range(size):
            for j in range(i):
                one, other = area[i] * error[i * size + j], area[j] * error[j * size + i]
                self.assertAlmostEqual(one, other, delta=1e-6 * abs(one))
        lines = (self.folder / "mtx.ff/sampling_error.mtx").read_text().splitlines()
        self.assertEqual([int(word) for word in lines[2].split()], [size, size, different])
        i, j, value = lines[3].split()
        self.assertAlmostEqual(float(value), error[(int(i) - 1) * size + int(j) - 1], delta=1e-8)

    def test_ten_lines_of_jacobi_solve_as_relight_does(self):
        self.find("-o", "room.ff", "--patches", "150")
        done = self.run_tool("relight", "room.ff", "--tolerance", "1e-10", "--json", "room.json", "-o", "room.vtp")
        self.assertEqual(done.returncode, GOOD, done.stderr)
        (size, _), F = load(self.folder / "room.ff/F.npy")
        (_, bands), E = load(self.folder / "room.ff/exitance.npy")
        _, rho = load(self.folder / "room.ff/reflectance.npy")
        _, area = load(self.folder / "room.ff/area.npy")
        absorbed = json.loads((self.folder / "room.json").read_text())["energy_balance"]["absorbed_W"]
        for band in range(bands):
            e, r = E[band::bands], rho[band::bands]
            B = list(e)
            for _ in range(60):  # 0.7^60 = 5e-10 of the light is left
                H = [sum(f * b for f, b in zip(F[i * size:(i + 1) * size], B)) for i in range(size)]
                B = [e[i] + r[i] * H[i] for i in range(size)]
            own = sum(area[i] * (1 - r[i]) * H[i] for i in range(size))
            # Stored form factors are floats.
            self.assertAlmostEqual(own, absorbed[band], delta=2e-6 * absorbed[band])

    def test_short_cuts_can_be_left_out(self):
        self.find("-o", "all.ff", "--patches", "300")
        counts = json.loads((self.folder / "all.ff/info.json").read_text())["counts"]
        self.find("-o", "few.ff", "--patches", "300", "--without", "free", "--without", "far")
        info = json.loads((self.folder / "few.ff/info.json").read_text())
        self.assertEqual(info["options"]["without"], ["free", "far"])
        self.assertGreater(info["counts"]["shadow_rays"], counts["shadow_rays"])
        self.assertEqual(info["counts"]["free_pairs"], 0)

    def test_groups_with_both_sides_are_said_to_be_shares_of_both(self):
        # Unit squares that share an edge: 0.20004 of the light from a front, or half of that for light from both sides.
        corners = ("0 0 0", "1 0 0", "1 1 0", "0 1 0", "0 1 1", "0 0 1")
        lines = [f"v {corner}" for corner in corners] + ["g source", "f 1 2 3 4", "g receiver", "f 1 4 5 6"]
        (self.folder / "squares.obj").write_text("\n".join(lines) + "\n")
        for sides, expected in (("both", "0.10002"), ("front", "0.20004")):
            done = self.run_tool("form-factors", "squares.obj", "-o", f"{sides}.ff", "--patches", "2", "--by", "object",
                                 "--sides", sides)
            self.assertEqual(done.returncode, GOOD, done.stderr)
            self.assertIn(f"source    0.00000  {expected}", done.stdout)
            self.assertEqual("note: both_sides: " in done.stderr, sides == "both")

    def test_every_estimator_finds_about_the_same(self):
        def mean_of(estimator):
            done = self.find("-o", "F.npy", "--patches", "60", "--no-closure", "--samples", "256", "--estimator", estimator)
            self.assertIn(f"estimator {estimator}", done.stdout)
            (size, _), F = load(self.folder / "F.npy")
            return sum(F) / size

        auto = mean_of("auto")
        for estimator in ("area", "point-polygon", "hemisphere", "contour"):
            # The mean row sum: about 1000 pairs with 256 samples each, and touching pairs, for which area sampling is
            # inaccurate.
            self.assertAlmostEqual(mean_of(estimator), auto, delta=0.03, msg=estimator)
        self.find("-o", "area.ff", "--patches", "60", "--estimator", "area")
        self.assertFalse((self.folder / "area.ff/sampling_error.npy").exists())
        self.run_tool("solve", "room.obj", "--json", "area.json", "--form-factors", "area.ff")
        report = json.loads((self.folder / "area.json").read_text())
        self.assertEqual(report["plan"]["estimator"], "area")

    def test_matrix_alone_in_both_formats_tells_the_same(self):
        self.find("-o", "F.npy", "--patches", "60")
        self.find("-o", "F.mtx", "--patches", "60")
        (size, _), F = load(self.folder / "F.npy")
        lines = [line for line in (self.folder / "F.mtx").read_text().splitlines() if not line.startswith("%")]
        self.assertEqual([int(word) for word in lines[0].split()], [size, size, len(lines) - 1])
        entries = {}
        for line in lines[1:]:
            i, j, value = line.split()
            entries[int(i) - 1, int(j) - 1] = float(value)
        for i in range(size):
            for j in range(size):
                self.assertAlmostEqual(entries.get((i, j), 0), F[i * size + j], delta=1e-8)

    def test_groups(self):
        done = self.find("-o", "room.ff", "--by", "material", "--patches", "150")
        self.assertIn("white", done.stdout)
        with (self.folder / "room.ff/by_material.csv").open(newline="") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["from", "area_m2", "white", "lamp"])
        area = {row[0]: float(row[1]) for row in rows[1:]}
        # 24 m^2 of walls, and both sides of the plate and of the lamp.
        self.assertAlmostEqual(area["white"], 26, places=6)
        self.assertAlmostEqual(area["lamp"], 0.5, places=6)
        F = {row[0]: dict(zip(rows[0][2:], map(float, row[2:]))) for row in rows[1:]}
        self.assertAlmostEqual(area["lamp"] * F["lamp"]["white"], area["white"] * F["white"]["lamp"], places=7)

    def test_solve_takes_them_with_any_material(self):
        self.find("-o", "room.ff", "--max-edge", "0.5")
        for setting in ([], ["--set", "white.reflectance=0.2,0.3,0.9"]):
            self.run_tool("solve", "room.obj", "--json", "fresh.json", "--max-edge", "0.5", "--no-error-bars", *setting)
            done = self.run_tool("solve", "room.obj", "--json", "stored.json", "--form-factors", "room.ff/", *setting)
            self.assertEqual(done.returncode, GOOD, done.stderr)
            fresh, stored = (json.loads((self.folder / name).read_text()) for name in ("fresh.json", "stored.json"))
            self.assertEqual(fresh["mesh"], stored["mesh"])
            for a, b in zip(fresh["energy_balance"]["absorbed_W"], stored["energy_balance"]["absorbed_W"]):
                self.assertAlmostEqual(a, b, delta=1e-6 * a)

    def test_solve_without_closure_takes_raw_ones_alone(self):
        self.find("-o", "closed.ff", "--max-edge", "0.5")
        self.find("-o", "raw.ff", "--max-edge", "0.5", "--no-closure")
        done = self.run_tool("solve", "room.obj", "--json", "a.json", "--form-factors", "closed.ff", "--no-closure")
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("--no-closure", done.stderr)
        for words in (["--form-factors", "raw.ff"], ["--max-edge", "0.5"]):
            done = self.run_tool("solve", "room.obj", "--json", "a.json", "-v", "--no-closure", *words)
            self.assertEqual(done.returncode, GOOD, done.stderr)
            report = json.loads((self.folder / "a.json").read_text())
            self.assertEqual(report["transport"]["closure"], "none: not wanted")
            for key in ("min", "mean", "max", "rms_defect"):
                self.assertAlmostEqual(report["transport"]["raw_row_sum"][key], report["transport"]["row_sum"][key], 6)
            balance = report["energy_balance"]
            for k in range(3):
                gone = sum(balance[f"{way}_W"][k] for way in ("absorbed", "escaped", "lost_at_backs", "defect"))
                self.assertAlmostEqual(gone, balance["emitted_W"][k], delta=1e-5 * balance["emitted_W"][k])
            self.assertGreater(abs(balance["defect_W"][0]), 1e-6)

    def test_form_factors_of_another_geometry_are_refused(self):
        self.find("-o", "room.ff", "--patches", "60")
        self.write("room.obj", ROOM.replace("v -0.5 -0.5 1\n", "v -0.5 -0.5 1.0000001\n"))
        done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--form-factors", "room.ff")
        self.assertEqual(done.returncode, INPUT)
        for words in ("room.ff: found form factors of", "expected those of", "compute them again"):
            self.assertIn(words, done.stderr)
        self.assertFalse((self.folder / "a.vtp").exists())

    def test_they_tell_whether_patches_end_at_lines_of_contact(self):
        for words, lines in (([], True), (["--no-contact-lines"], False)):
            self.find("-o", "room.ff", "--patches", "60", *words)
            info = json.loads((self.folder / "room.ff" / "info.json").read_text())
            self.assertEqual(info["options"]["contact_lines"], lines)
            done = self.run_tool("solve", "room.obj", "--json", "a.json", "--form-factors", "room.ff")
            self.assertEqual(done.returncode, GOOD, done.stderr)
            done = self.run_tool("solve", "room.obj", "--json", "a.json", "--form-factors", "room.ff",
                                 "--no-contact-lines")
            self.assertEqual(done.returncode, INPUT if lines else GOOD, done.stderr)

    def test_they_tell_whether_patches_are_graded(self):
        """The stored patches fit the box by its faces alone."""
        self.find("-o", "room.ff", "--patches", "300", "--graded-edges")
        info = json.loads((self.folder / "room.ff" / "info.json").read_text())
        self.assertEqual(info["options"]["graded_edges"], True)
        done = self.run_tool("solve", "room.obj", "--json", "a.json", "--form-factors", "room.ff")
        self.assertEqual(done.returncode, GOOD, done.stderr)

    def test_those_of_a_far_smaller_model_are_refused_before_it_is_cut(self):
        """A room a thousand times as large would need 60 million patches with these edges."""
        self.find("-o", "room.ff", "--patches", "60")
        large = [" ".join(["v", *(str(1000 * float(x)) for x in line.split()[1:])]) if line.startswith("v ") else line
                 for line in ROOM.splitlines()]
        self.write("room.obj", "\n".join(large) + "\n")
        done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--form-factors", "room.ff")
        self.assertEqual(done.returncode, INPUT, done.stderr)
        self.assertIn("room.ff: ", done.stderr)
        self.assertIn("room.obj", done.stderr)

    def test_a_model_without_a_lamp_will_do(self):
        self.write("room.mtl", "newmtl white\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0 0 0\n")
        self.find("-o", "room.ff", "--patches", "60")
        self.assertEqual(json.loads((self.folder / "room.ff/info.json").read_text())["options"]["sides"], "front")

    def test_same_bits_for_any_number_of_threads(self):
        for threads in ("1", "3"):
            self.find("-o", f"F{threads}.npy", "--patches", "150", "--threads", threads)
        self.assertEqual((self.folder / "F1.npy").read_bytes(), (self.folder / "F3.npy").read_bytes())

    def test_only_an_earlier_result_is_replaced(self):
        self.find("-o", "room.ff", "--patches", "60")
        self.find("-o", "room.ff", "--patches", "60", "--matrix", "mtx")
        self.assertFalse((self.folder / "room.ff/F.npy").exists())
        (self.folder / "mine").mkdir()
        (self.folder / "mine/notes.txt").write_text("mine")
        before = content(self.folder)
        self.assertIn("empty it first", self.find("-o", "mine", "--patches", "60", code=OUTPUT).stderr)
        self.find("-o", ".", code=OUTPUT)
        self.find("-o", "room.mtl", code=OUTPUT)
        self.find("-o", "missing/room.ff", code=OUTPUT)
        self.assertEqual(content(self.folder), before)

    def test_refusals(self):
        for words, code in (([], USAGE), (["-o", "a.ff", "--by", "colour"], USAGE),
                            (["-o", "a.ff", "--estimator", "magic"], USAGE), (["-o", "a.ff", "--without", "x"], USAGE),
                            (["-o", "a.ff", "--estimator", "area", "--without", "far"], USAGE),
                            (["-o", "F.npy", "--matrix", "mtx"], USAGE), (["-o", "room.obj"], USAGE),
                            (["-o", "a.ff", "--patches", "9", "--max-edge", "1"], USAGE),
                            (["-o", "a.ff", "--patches", "100000000"], MEMORY)):
            self.find(*words, code=code)
        done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--form-factors", "missing.ff")
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("info.json", done.stderr)
        self.find("-o", "mm.ff", "--patches", "60", "--unit", "mm")
        done = self.run_tool("solve", "room.obj", "-o", "a.vtp", "--form-factors", "mm.ff")
        self.assertEqual(done.returncode, INPUT)
        self.assertIn("0.001 m per unit", done.stderr)


if __name__ == "__main__":
    unittest.main()
