"""The reference pages list exactly the keys, columns, arrays and files that the program reads and writes."""
import csv
import json
import os
import pathlib
import re
import unittest

from support import ToolTest

MESHES = pathlib.Path(os.environ["PATCHLIGHT_MESHES"])
ROOT = MESHES.parent
REFERENCE = ROOT / "docs" / "reference"
OUTPUTS = REFERENCE / "outputs"

# Words in tables that are values or file names.
NO_KEYS = {"null", "lx", "W/m^2", "disagrees", "inconclusive", "agrees", "all", "tiles", "rays", "on-demand"}

# Keys of diagnostics, which may be absent.
OF_DIAGNOSTICS = {"code", "severity", "text"}


def section(page, heading=None):
    """The text of a page, or of one section with its subsections."""
    text = page.read_text(encoding="utf-8")
    if heading is None:
        return text
    level = len(heading) - len(heading.lstrip("#"))
    begin = text.index(f"\n{heading}\n") + len(heading) + 2
    end = re.search(rf"^#{{1,{level}}} ", text[begin:], re.MULTILINE)
    return text[begin:begin + end.start()] if end else text[begin:]


def cells(text):
    """The cells of all tables, row by row, without heads."""
    for block in re.findall(r"(?:^\|.*\n?)+", text, re.MULTILINE):
        for row in block.splitlines()[2:]:
            yield [cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]]


def codes(text):
    return re.findall(r"`([^`]+)`", text)


def documented(text, columns=None):
    """Names between backticks in these columns of the tables."""
    return {name for row in cells(text) for k, cell in enumerate(row) if columns is None or k in columns for name in codes(cell)}


def parts(names):
    """`rooms[].floor` and `.walls` are rooms, floor, walls."""
    return {part for name in names if not name.startswith("--") for part in re.split(r"[\[\].]+", name) if part}


def keys(value):
    """All keys of a JSON value."""
    if isinstance(value, dict):
        for key, below in value.items():
            yield key
            yield from keys(below)
    elif isinstance(value, list):
        for below in value:
            yield from keys(below)


def arrays(file):
    """Names of the arrays of a .vtp, by kind."""
    head = file.read_bytes().split(b"<AppendedData")[0].decode("utf-8")
    return {kind: set(re.findall(r'<(?:Data)?Array[^>]*? Name="([^"]*)"', part))
            for kind, part in re.findall(r"<(FieldData|PointData|CellData)\b[^>]*>(.*?)</\1>", head, re.DOTALL)}


class DocumentedTest(ToolTest):
    def setUp(self):
        super().setUp()
        (self.folder / "meshes").symlink_to(MESHES)
        self.write("desk.pts", "0.1 0.1 0.1 0 1 0\n")
        self.write("lamps.toml", 'up = "y"\n[[model]]\nfile = "meshes/cornell_box.obj"\n[[luminaire]]\nname = "panel"\nkind = "ies"\n'
                                 'file = "meshes/panel.ies"\nposition = [0.3, 0.5, 0.3]\n[[luminaire]]\nkind = "point"\nlumens = 10\n'
                                 'position = [0.1, 0.4, 0.2]\n')

    def tool(self, *words, codes_of_success=(0,)):
        done = self.run_tool(*words)
        self.assertIn(done.returncode, codes_of_success, done.stderr)
        return done

    def json(self, name):
        return json.loads((self.folder / name).read_text())

    def assert_same(self, written, names, optional=()):
        self.assertEqual(written - names, set(), "written, but on no page")
        self.assertEqual(names - written - set(optional) - NO_KEYS, set(), "on a page, but not written")

    def solve(self, model, name, *words):
        self.tool("solve", model, "--patches", 150, "--error-bars", "-q", "--up", "y", "--json", f"{name}.json", "-o", f"{name}.vtp",
                  "--points", "desk.pts", "--points-output", f"{name}.csv", "--points-output", f"{name}.pts.vtp", *words)

    def solved(self):
        self.solve("meshes/cornell_box.obj", "rgb", "--ambient-occlusion", "1m")
        self.solve("meshes/cornell_box_spectra.toml", "bands")
        self.solve("meshes/cornell_box.obj", "sky", "--set", "light.exitance=0", "--sky", "overcast:10000lx")
        self.solve("lamps.toml", "lamps")
        return "rgb", "bands", "sky", "lamps"

    def test_results_of_solve(self):
        names = self.solved()
        found = set().union(*(set(keys(self.json(f"{name}.json"))) for name in names))
        text = section(OUTPUTS / "report-json.md", "## solve and relight")
        self.assert_same(found, parts(documented(text)), {"relative_error_by_space", "outside", "error_solver", *OF_DIAGNOSTICS})

        page = OUTPUTS / "vtp.md"
        every = [arrays(self.folder / f"{name}.vtp") for name in names]
        for kind, heading in (("CellData", "## Cell arrays"), ("PointData", "## Point arrays"), ("FieldData", "## Field data")):
            written = {name for one in every for name in one[kind] if not name.startswith("unit_")}
            wanted = {name for name in documented(section(page, heading), {0}) if not name.startswith("unit_")}
            self.assert_same(written - {"ambient_occlusion"}, wanted - {"ambient_occlusion", "..."})
        self.assertIn("ambient_occlusion", every[0]["CellData"] & every[0]["PointData"])

        page = OUTPUTS / "csv.md"
        columns = documented(section(page, "## CSV columns"), {0})
        columns = {name for text in columns for name in text.split(",") if name != "..."}
        bands = re.compile(r"^((?:E|SE(?:_rays|_sampling|_mesh|_solver)?)_)(?:[rgb]|\d+-\d+ nm)$")
        written = set()
        for name in names:
            with open(self.folder / f"{name}.csv", newline="", encoding="utf-8") as file:
                written |= {bands.sub(r"\1r", column) for column in next(csv.reader(file))}
        self.assert_same(written, {bands.sub(r"\1r", column) for column in columns})
        every = [arrays(self.folder / f"{name}.pts.vtp") for name in names]
        written = {name for one in every for name in one["CellData"]}
        text = section(page, "## VTP")
        self.assert_same(written, documented(text, {0}))
        self.assertLessEqual({name for one in every for name in one["FieldData"]}, set(codes(text)))

    def test_luminaires_are_those_of_the_scene_file(self):
        self.solve("lamps.toml", "lamps")
        panel, point = self.json("lamps.json")["input"]["luminaires"]
        self.assertEqual((panel["name"], panel["kind"], panel["position_m"], panel["aim"]), ("panel", "ies", [0.3, 0.5, 0.3], [0, -1, 0]))
        self.assertTrue(panel["file"].endswith("panel.ies"), panel["file"])
        self.assertEqual(panel["place"], "lamps.toml:4")
        self.assertEqual((point["kind"], point["file"], point["position_m"]), ("point", None, [0.1, 0.4, 0.2]))
        self.tool("check", "lamps.toml", "--json", "check.json")
        self.assertEqual(self.json("check.json")["luminaires"], [panel, point])

    def test_other_reports(self):
        page = OUTPUTS / "report-json.md"
        self.tool("plan", "meshes/cornell_box.obj", "--json", "plan.json")
        self.assert_same(set(keys(self.json("plan.json"))), parts(documented(section(page, "## plan"), {0, 1})), OF_DIAGNOSTICS)
        self.tool("crosscheck", "meshes/cornell_box.obj", "--patches", 150, "--sample-patches", 10, "--paths", 64, "--json", "paths.json",
                  codes_of_success=(0, 5))
        found = set(keys(self.json("paths.json")))
        of_errors = {"mesh", "form_factor", "solver", "total", "display", "inside"}
        self.assert_same(found - of_errors, parts(documented(section(page, "## crosscheck"))), {"inside", "outside"})
        self.tool("check", "lamps.toml", "--json", "lamps.json")
        self.tool("check", "meshes/cornell_box.obj", "--sides", "auto", "--sky", "clear:9000lx", "--sun", "40,180:80000lx", "--json", "check.json", "--problems",
                  "problems.vtp")
        page = REFERENCE / "check-problems.md"
        self.assert_same(set(keys([self.json("check.json"), self.json("lamps.json")])), parts(documented(section(page, "## JSON"))), {"file", "line", *OF_DIAGNOSTICS})
        found = arrays(self.folder / "problems.vtp")
        self.assert_same(found["CellData"] | found["FieldData"], documented(section(page, "## ParaView"), {0}))

    def test_folders(self):
        page = OUTPUTS / "form-factor-folder.md"
        box = ("meshes/cornell_box.obj", "--patches", 150, "-q", "-o")
        self.tool("form-factors", *box, "pairs", "--by", "material")
        self.tool("form-factors", *box, "open", "--no-closure", "--by", "object")
        self.tool("form-factors", *box, "matrix", "--matrix", "mtx")
        self.tool("form-factors", *box, "rows", "--method", "rays")
        self.tool("form-factors", "meshes/bathroom.toml", "--method", "rays", "--patches", 500, "-q", "-o", "specular")

        def files(*folders):
            return {re.sub(r"_[01](\.npy)$", r"_k\1", file.name) for name in folders for file in (self.folder / name).iterdir()}

        self.assert_same(files("pairs", "open", "matrix") - {"sampling_error.mtx"}, documented(section(page, "## Pair method"), {0}) - {".mtx"})
        self.assert_same(files("rows", "specular"), documented(section(page, "## Ray method"), {0}))
        facts = [self.json(f"{name}/info.json") for name in ("pairs", "open", "rows", "specular")]
        for fact in facts:
            fact["files"], fact["input"], fact["counts"] = None, None, None
        text = section(page, "## `info.json`")
        self.assert_same(set().union(*(set(keys(fact)) for fact in facts)), set(codes(text)) - {"info.json", "--no-closure", "transport"},
                         {"classes"})
        scene = self.json("specular/scene.json")
        scene["lights"] = dict.fromkeys(scene["lights"])
        scene["views"] = dict.fromkeys(scene["views"])
        self.assert_same(set(keys(scene)), parts(documented(section(page, "## `scene.json`"))))
        self.tool("solve", "meshes/cornell_box.obj", "--patches", 150, "-q", "--lightmap", "map", "--texel", "5cm")
        page = OUTPUTS / "lightmap.md"
        names = documented(section(page), {0})
        self.assertLessEqual(files("map"), names)
        self.assertLessEqual(set(keys(self.json("map/lightmap.json"))), names | set(codes(section(page))))

    def test_studies(self):
        page = OUTPUTS / "studies.md"
        self.tool("compare-solvers", "meshes/cornell_box.obj", "--patches", 100, "-q", "--no-series", "-o", "solvers")
        self.tool("convergence", "meshes/cornell_box.obj", "--patches", 50, "-q", "--no-estimators", "-o", "study")
        for heading, folder, tables in (("## compare-solvers", "solvers", ("compare.csv", "history.csv")),
                                        ("## convergence", "study", ("study.csv",))):
            names = parts(documented(section(page, heading))) | {name for name in codes(section(page, heading))}
            for table in tables:
                with open(self.folder / folder / table, newline="", encoding="utf-8") as file:
                    self.assertLessEqual(set(next(csv.reader(file))), names)
            facts = self.json(f"{folder}/{tables[0].replace('csv', 'json')}")
            facts["input"] = None
            self.assertLessEqual(set(keys(facts)), names)

    def test_keys_of_the_scene_file(self):
        """Compares with the readers' own lists of keys."""
        sources = sorted((ROOT / "src" / "input" / "toml").glob("*.cpp"))
        text = "".join(file.read_text(encoding="utf-8") for file in sources)
        allowed = {name for keys in re.findall(r"allow_keys\(\*?\w+, \{(.*?)\}\)", text, re.DOTALL) for name in re.findall(r'"(\w+)"', keys)}
        of_luminaires = re.search(r"void require_keys_of.*?allow_keys", text, re.DOTALL)[0]
        allowed |= set(re.findall(r'"(\w+)"', of_luminaires))
        page = section(REFERENCE / "scene-file.md")
        self.assertEqual({name for name in allowed if f"`{name}`" not in page and f"[{name}]" not in page and f"{{{name} = " not in page},
                         {"degrees"} if '{axis = "z", degrees = 30}' in page else set())
        words = {name for row in cells(page) if row for name in codes(row[0]) + (codes(row[1]) if "[" in row[0] or not row[0] else [])}
        self.assertEqual({name for name in words if re.fullmatch(r"[a-z_]+", name)} - allowed, set())

    def test_diagnostics(self):
        header = (ROOT / "include/patchlight/base/diagnostics.h").read_text(encoding="utf-8")
        enum = re.search(r"enum class DiagnosticCode.*?\{(.*?)\n\};", header, re.DOTALL)[1]
        codes_there = re.findall(r"^  (\w+),? *///<", enum, re.MULTILINE)
        source = (ROOT / "src/base/diagnostics.cpp").read_text(encoding="utf-8")
        names = re.search(r"code_names =\n(.*?);", source, re.DOTALL)[1]
        self.assertEqual(names.replace('"', "").split(), codes_there)
        page = REFERENCE / "diagnostics.md"
        named = {name for heading in ("## Errors", "## Warnings", "## Remarks", "## Notes") for name in documented(section(page, heading), {0})}
        self.assertEqual(named, set(codes_there))


if __name__ == "__main__":
    unittest.main()
