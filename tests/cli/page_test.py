"""The page of the tool: --html of solve, relight, compare, study and render."""
import base64
import json
import re
import unittest
import zlib

from room import MATERIALS
from support import ToolTest


def data_of(page):
    """The data in the page."""
    return json.loads(re.search(r'id="data">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)[1])


def bytes_of(packed):
    """An array of single bytes of the page."""
    return zlib.decompress(base64.b64decode(packed["packed"]))


class PageTest(ToolTest):
    def made(self, *arguments):
        """Pages of solve and relight have a picture, which is small here."""
        size = ("--picture", "page.png", "--size", "40x30") if arguments[0] in ("solve", "relight") else ()
        done = self.run_tool(*arguments, *size, "--html", "page.html")
        self.assertEqual(done.returncode, 0, done.stderr)
        return data_of(self.folder / "page.html")

    def test_solve_writes_model_report_and_picture(self):
        data = self.made("solve", "room.obj", "--patches", 200, "--json", "room.json")
        report = json.loads((self.folder / "room.json").read_text())
        self.assertEqual(data["report"]["materials"], report["materials"])
        self.assertEqual(data["report"]["energy_balance"], report["energy_balance"])
        self.assertEqual(data["model"]["patches"], report["mesh"]["patches"])
        self.assertEqual(len(data["pictures"]), 1)
        self.assertIn("--html page.html", data["command_line"])

    def test_light_of_rooms_is_marked_where_the_mesh_is_coarse(self):
        for patches, is_coarse in ((30, True), (2500, False)):
            room = self.made("solve", "room.obj", "--patches", patches, "--no-error-bars")["report"]["room_surfaces"]
            self.assertEqual(room["rooms"][0]["floor"]["coarse"], is_coarse)
            if is_coarse:
                self.assertIn("Sensors on a grid", room["note"])

    def test_notes_of_pages_and_reports_name_options(self):
        """Fields of the library, e.g. read.settings or assembly.storage, have no meaning for users of the tool."""
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ke 10 9 8\nd 0.2"))
        fields = r"\b(?:read|mesh|assembly|solver|accuracy|resources|effects)\.[a-z]"
        data = self.made("solve", "room.obj", "--patches", 200, "--json", "room.json")
        self.assertIn("--set lamp.transmittance=0", json.dumps(data["diagnostics"]))
        self.assertIn("--method ", json.dumps(data["report"]["plan"]["notes"]))
        for text in (json.dumps(data["diagnostics"]), json.dumps(data["report"]), (self.folder / "room.json").read_text()):
            self.assertNotRegex(text, fields)
        for command in ("check", "plan"):
            self.assertEqual(self.run_tool(command, "room.obj", "--json", f"{command}.json").returncode, 0)
            self.assertNotRegex((self.folder / f"{command}.json").read_text(), fields)

    def test_luminaires_and_mirrors_are_named(self):
        self.write("room.mtl", MATERIALS.replace("Ke 10 9 8", "Ke 10 9 8\nKs 0.9 0.8 0.7\nillum 3"))
        self.write("lit.toml", '[[model]]\nfile = "room.obj"\n[[luminaire]]\nname = "spot"\nkind = "spot"\nposition = [0, 0, 1.5]\n'
                               'lumens = 100\nbeam_angle = 20\nfield_angle = 40\n')
        data = self.made("solve", "lit.toml", "--patches", 100)
        self.assertEqual([data["model"]["materials"][k] for k in data["model"]["mirrors"]], ["lamp"])
        spot, = data["report"]["input"]["luminaires"]
        self.assertEqual((spot["name"], spot["kind"], spot["position_m"], spot["aim"]), ("spot", "spot", [0, 0, 1.5], [0, 0, -1]))

    def test_page_alone_is_enough_to_write(self):
        self.assertEqual(self.made("solve", "room.obj", "--patches", 100, "--accuracy", "20%")["report"]["accuracy"][0]["samples"] > 0, True)

    def test_a_single_mesh_tells_what_it_cost(self):
        step = self.made("solve", "room.obj", "--patches", 100, "--error-bars")["report"]["accuracy"][0]
        self.assertGreater(step["seconds"], 0)
        self.assertGreater(step["cpu_seconds"], 0)

    def test_by_day_pages_of_solve_and_render_go_by_the_same_patches(self):
        # A room of 9 m that is open at one end.
        self.write("open.obj", """v 0 0 0
v 3 0 0
v 3 9 0
v 0 9 0
v 0 0 3
v 3 0 3
v 3 9 3
v 0 9 3
f 1 2 3 4
f 5 8 7 6
f 1 5 6 2
f 1 4 8 5
f 2 6 7 3
""")
        self.write("day.toml", '[[model]]\nfile = "open.obj"\n[sky]\nkind = "uniform"\nilluminance = 10000\n')
        solved = self.made("solve", "day.toml", "--patches", 300, "-o", "day.vtp")["model"]
        stored = self.made("render", "day.toml", "--solution", "day.vtp", "-o", "day.png", "--picture-quality", "draft", "--size", "32x24")["model"]
        self.assertIn("enclosed", solved["rows"])
        self.assertEqual(stored["rows"]["enclosed"], solved["rows"]["enclosed"])
        self.assertEqual([look["name"] for look in stored["looks"]], [look["name"] for look in solved["looks"]])
        self.assertEqual(len(stored["looks"]), 2)

    def test_sensors_have_their_values(self):
        self.write("points.txt", "0.5 0.5 0.1 0 0 1\n0.4 0.5 0.1 0 0 1\n")
        data = self.made("solve", "room.obj", "--patches", 100, "--points", "points.txt")
        self.assertEqual(data["sensors"][0]["values"]["components"], 1)
        self.assertEqual(data["report"]["sensors"]["groups"][0]["sensors"], 2)

    def test_relight_compare_study_and_render_write_pages(self):
        self.run_tool("form-factors", "room.obj", "--patches", 100, "-o", "room.ff")
        self.assertEqual(self.made("relight", "room.ff")["report"]["mesh"]["patches"] > 0, True)
        compared = self.made("compare-solvers", "room.obj", "--patches", 100, "--solvers", "jacobi,cg", "-o", "compared")
        self.assertEqual([run["solver"] for run in compared["comparison"]["runs"]], ["jacobi", "cg"])
        self.assertGreater(compared["model"]["patches"], 0)
        studied = self.made("convergence", "room.obj", "--patches", 100, "--sizes", 2, "--no-adaptive", "--no-estimators", "-o", "studied")
        self.assertGreater(len(studied["study"]["settings"]), 1)
        self.run_tool("solve", "room.obj", "--patches", 100, "-o", "room.vtp")
        rendered = self.made("render", "room.obj", "--solution", "room.vtp", "-o", "room.png", "--picture-quality", "draft", "--size", "40x30")
        self.assertEqual(rendered["pictures"][0]["width"], 40)
        self.assertNotIn("report", rendered)

    def test_refuses_what_is_no_page(self):
        done = self.run_tool("solve", "room.obj", "--html", "page.pdf")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--html: found 'page.pdf'", done.stderr)
        done = self.run_tool("compare-solvers", "room.obj", "-o", "folder", "--html", "folder/page.html")
        self.assertEqual(done.returncode, 1)
        self.assertIn("--html: 'folder/page.html' ", done.stderr)
        done = self.run_tool("solve", "room.obj", "--html", "page.html", "--json", "page.html")
        self.assertEqual(done.returncode, 1)

    def test_faces_under_others_lie_deeper_and_unlit_ones_are_marked(self):
        # A lit cube with a rug on its floor, and beside it a closed cube without light.
        cube = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
        lines, corner = [], 0
        for left, size in ((0, 1), (3, 0.5)):
            lines += [f"v {left + size * x} {size * y} {size * z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
            lines += ["f " + " ".join(str(corner + k + 1) for k in reversed(face)) for face in cube]
            corner += 8
        lines += ["v 0.3 0.3 0", "v 0.7 0.3 0", "v 0.7 0.7 0", "v 0.3 0.7 0", "f 17 18 19 20"]
        self.write("rug.obj", "\n".join(lines) + "\n")
        self.write("rug.toml", '[[model]]\nfile = "rug.obj"\n[[luminaire]]\nkind = "point"\nposition = [0.5, 0.5, 0.6]\nlumens = 1000\n')
        model = self.made("solve", "rug.toml", "--sides", "both", "--patches", 300)["model"]
        layer, dark, side = (bytes_of(model["rows"][name]) for name in ("layer", "dark", "side"))
        self.assertEqual(set(layer), {0, 1})
        self.assertIn(1, dark)
        self.assertIn(0, dark)
        self.assertEqual(len(layer), len(side))

    def test_hostile_names_stay_text(self):
        name = "</script><script>alert(1)</script>"
        self.write("room.mtl", (self.folder / "room.mtl").read_text().replace("newmtl white", f"newmtl {name}"))
        self.write("room.obj", (self.folder / "room.obj").read_text().replace("usemtl white", f"usemtl {name}"))
        data = self.made("solve", "room.obj", "--patches", 100)
        self.assertIn(name, [material["name"] for material in data["report"]["materials"]])
        self.assertNotIn("alert(1)</script>", (self.folder / "page.html").read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main()
