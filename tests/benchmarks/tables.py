#!/usr/bin/env python3
"""Measures patchlight and writes the pages of docs/benchmarks.

usage: tests/benchmarks/tables.py NAME... [--size small|full] [--tool TOOL] [--programs FOLDER] [--models FOLDER]
                                  [--references FOLDER] [--rooms N] [--out FOLDER]
NAME: accuracy, speed, form-factors, solvers, pictures, real-models, validation, random_rooms, or all of them: all.

TOOL is build/src/patchlight, and FOLDER of the programs build/tests/benchmarks, where `cmake --build build --target
benchmarks` puts them. Real models and references of other programs are not part of this repository; without their
folders these sections are left out. Small runs prove that the program works; their pages go to build/benchmarks.
"""
import argparse
import array
import csv
import datetime
import json
import math
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
MESHES = ROOT / "meshes"
sys.path.insert(0, str(ROOT / "scripts"))

from color_difference import difference, lab, xyz_of  # noqa: E402
from read_exr import layers  # noqa: E402
from read_vtp import read_vtp  # noqa: E402


class Failed(Exception):
    """A run that ended with an error."""


class Bench:
    """Runs programs, measures them, and holds the options of a run."""

    def __init__(self, options, scratch):
        self.full = options.size == "full"
        self.tool = options.tool.resolve()
        self.programs = options.programs.resolve()
        self.models = options.models and options.models.resolve()
        self.references = options.references and options.references.resolve()
        self.out = options.out
        self.rooms = options.rooms
        self.scratch = scratch
        self.cpu_seconds = 0.0

    def size(self, small, full):
        return full if self.full else small

    def run(self, *words, folder=None, accept=(0,)):
        """Output, processor seconds of all threads, and the largest memory in GB."""
        words = [str(word) for word in words]
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as errors:
            with subprocess.Popen(words, cwd=folder or self.scratch, stdout=out, stderr=errors) as process:
                _, status, used = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
            seconds = used.ru_utime + used.ru_stime
            self.cpu_seconds += seconds
            out.seek(0)
            if process.returncode not in accept:
                errors.seek(0)
                lines = errors.read().strip().splitlines() or ["no message"]
                raise Failed(f"`{' '.join(words[:2])}` ends with {process.returncode}: {lines[-1][:200]}")
            return out.read(), seconds, used.ru_maxrss * 1024 / 1e9

    def patchlight(self, *words, **more):
        return self.run(self.tool, *words, **more)

    def program(self, name, *words):
        return self.run(self.programs / name, *words)[0]

    def solve(self, *words, **more):
        """The report of a run, its processor seconds and memory."""
        report = self.scratch / "report.json"
        _, seconds, memory = self.patchlight("solve", *words, "-q", "-o", self.scratch / "result.vtp", "--json", report, **more)
        return json.loads(report.read_text()), seconds, memory

    def script(self, name, *words):
        self.run(sys.executable, ROOT / "scripts" / name, *words)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


def percent(value, digits=2):
    return "-" if value is None else f"{100 * value:.{digits}g} %"


def rms(values):
    return math.sqrt(statistics.fmean(v * v for v in values))


def quantile(values, fraction):
    return sorted(values)[int(fraction * (len(values) - 1))]


def values_of(file):
    """The numbers of an .npy file of floats or doubles."""
    data = file.read_bytes()
    begin = 10 + int.from_bytes(data[8:10], "little")
    return array.array("d" if b"<f8" in data[:begin] else "f", data[begin:])


# accuracy


def accuracy(b):
    b.script("make_varied_rooms.py", b.scratch / "rooms")
    rooms = sorted((b.scratch / "rooms").glob("*.obj"))[:b.size(1, 6)] + [MESHES / "cornell_box.obj", MESHES / "two_rooms.obj"][:b.size(1, 2)]
    asked = b.program("benchmark_accuracy", b.size(1200, 4000), b.size("5", "3,1"), *rooms)
    return [
        "## Requested accuracy\n\n`solve --accuracy` refines the mesh until the estimated error is below the requested one. "
        f"The reference is a solution of at least {b.size(1200, 4000)} patches with 32 samples per pair. Where a solution "
        "has more than a quarter of its patches, the true error is not known (-).\n\n" + asked +
        "\nThe columns *true* and *stated* are errors of the patches relative to the reflected light. A patch is within its bar if its "
        "true error is below the standard error that patchlight prints.\n",
        crosschecks(b), cornell(b), spectral_bands(b)]


def crosschecks(b):
    rows = []
    for model, patches, paths in [("cornell_box", 300, 256)] if not b.full else [
            ("cornell_box", 4000, 4096), ("cornell_box", 16000, 16384), ("two_rooms", 2000, 4096), ("two_rooms", 8000, 16384)]:
        _, seconds, _ = b.patchlight("crosscheck", MESHES / f"{model}.obj", "--patches", patches, "--paths", paths, "--json",
                                     b.scratch / "check.json", accept=(0, 5))
        found = json.loads((b.scratch / "check.json").read_text())
        all_patches = next(part for part in found["parts"] if part["part"] == "all")
        rows.append((model, patches, paths, f"{seconds:.0f}", percent(found["relative_error"]["total"]), percent(max(all_patches["error"])),
                     percent(max(all_patches["noise"])), found["verdict"]))
    return ("## Crosscheck by path tracing\n\n`crosscheck` compares the irradiance of some patches with an independent path tracer.\n\n" +
            table(["model", "patches", "paths per patch", "CPU s", "stated error", "difference without noise", "noise of the paths", "verdict"], rows))


def cornell(b):
    folder = b.references and b.references / "cornell"
    if not folder or not (folder / "cornell_reference.csv").exists():
        return ""
    text = b.program("benchmark_cornell_reference", folder, *b.size([500], [2500, 5000, 10000, 20000]))
    rows = []
    for line in text.partition("without contact lines")[0].splitlines():
        if "points:" in line:
            patches, solve, gather = re.match(r"(\d+) patches.*solve ([\d.]+) CPU s, gather ([\d.]+)", line).groups()
        elif line.strip().startswith(("gathered", "interpolated")):
            median, error, bias = (statistics.fmean(float(v) for v in re.findall(pattern, line)) for pattern in
                                   (r"median ([\d.]+)", r"rms ([\d.]+)", r"bias ([-+\d.]+)"))
            how = line.split()[0]
            seconds = float(solve) + (float(gather) if how == "gathered" else 0)
            rows.append((patches, f"{seconds:.1f}", how, f"{median:.2f} %", f"{error:.2f} %", f"{bias:+.2f} %"))
    with open(folder / "time_error_cornell.csv", newline="", encoding="utf-8") as stream:
        others = [(row["system"], re.sub(r"(?<!\d)\.(?=\d)", "0.", row["settings"]), row["user_cpu_s"], row["rms_error_pct"] + " %", row["median_error_pct"].replace("(se)", "") + " %")
                  for row in csv.DictReader(stream) if row["measured_against"] != "stderr"]
    return ("## Cornell box\n\nThe reference is the irradiance at points of the open Cornell box: the weighted mean of two renderers, Radiance 5.4a "
            "(pure Monte Carlo) and Cycles 3.4.1. Its own median relative standard error is 0.18 %. Values are means of three bands.\n\n" +
            table(["patches", "CPU s", "value at a point", "median error", "rms error", "mean difference"], rows) +
            "\nThe renderers need the following times for the same points. Each is compared with the other one. They compute these points alone; "
            "patchlight computes the whole surface.\n\n" + table(["program", "settings", "CPU s", "rms error", "median error"], others))


def spectral_bands(b):
    rows = []
    scenes = {"color_chart_d65": "chart under D65", "color_chart_a": "chart under A", "cornell_box_spectra": "Cornell box"}
    for scene, title in list(scenes.items())[:b.size(1, 3)]:
        def solved(bands):
            words = (MESHES / f"{scene}.toml", "--bands", bands, "--patches", b.size(300, 2000), "--no-error-bars")
            report, _, _ = b.solve(*words)
            return read_vtp(b.scratch / "result.vtp")[2], report
        cells, report = solved("200")
        lamps = [k for k, material in enumerate(report["materials"]) if any(v > 0 for v in material["exitance_W_m2"])]
        is_lamp = [int(m) in lamps for (m,) in cells["material_id"]]
        xyz = xyz_of(cells)
        lamp = next(v for v, lit in zip(xyz, is_lamp) if lit)
        brightest = max(v[1] for v, lit in zip(xyz, is_lamp) if not lit)
        white = [value / lamp[1] * brightest for value in lamp]
        for bands in b.size(["rgb", "8"], ["rgb", "3", "6", "8", "16", "31", "81", "auto"]):
            arrays, report = solved(bands)
            errors = [0 if lit else difference(lab(a, white), lab(r, white)) for a, r, lit in zip(xyz_of(arrays), xyz, is_lamp)]
            mean = sum(e * a[0] for e, a in zip(errors, cells["area"])) / sum(a[0] for a in cells["area"])
            label = f"{len(arrays['radiance'][0])} (auto)" if bands == "auto" else bands
            seconds = sum(cost["cpu_seconds"] for cost in report["costs"] if cost["stage"] == "solve")
            rows.append((title, label, f"{max(errors):.2g}", f"{mean:.2g}", f"{seconds:.3f}"))
    return ("## Spectral bands\n\nColor errors against 200 bands, as CIE dE00, with the same patches and form factors. A dE00 of 1 is about the "
            "smallest visible difference.\n\n" + table(["scene", "bands", "worst patch", "mean by area", "solver, CPU s"], rows))


# speed


def speed(b):
    rows = []
    for model in ["cornell_box", "two_rooms"][:b.size(1, 2)]:
        for patches in b.size([500], [1000, 4000, 16000]):
            cells = [model, patches]
            for method in ("pairs", "rays"):
                report, seconds, memory = b.solve(MESHES / f"{model}.obj", "--sides", "front", "--patches", patches, "--method", method, "--error-bars")
                cells += [f"{seconds:.1f}", f"{memory:.2f}", percent(report["relative_error"]["total"])]
            rows.append(cells)
    (b.scratch / "large").mkdir()
    b.script("make_large_rooms.py", b.scratch / "large", 4)
    large = []
    for patches in b.size([5000], [30000, 100000, 300000]):
        report, seconds, memory = b.solve(b.scratch / "large" / "boxes.obj", "--method", "rays", "--patches", patches)
        large.append((report["mesh"]["patches"], f"{seconds:.0f}", f"{memory:.2f}", percent(report["relative_error"]["total"])))
    growth = b.run(sys.executable, ROOT / "tests/benchmarks/growth.py", b.tool, "--most", b.size(800, 20000))[0]
    return [
        "## Pairs and rays\n\nBoth methods with error bars. Errors are those that patchlight estimates, relative to the reflected light.\n\n" +
        table(["model", "patches", "pairs: CPU s", "GB", "error", "rays: CPU s", "GB", "error"], rows),
        "## Large rooms\n\nA closed room of 10 x 8 x 3 m with 500 boxes and four lamps, by the ray method.\n\n" +
        table(["patches", "CPU s", "GB", "error"], large),
        "## Growth of the model\n\n`check` on models with many things of one kind: CPU seconds by their number, and the exponent p of "
        "time ~ n^p between the last two.\n\n" + growth]


# form-factors


def form_factors(b):
    b.script("make_rooms.py", b.scratch / "rooms")
    patches = b.size(300, 2000)
    costs = []
    for model, name in [(MESHES / "two_rooms.obj", "two rooms with furniture"), (b.scratch / "rooms" / "closed_room_10.obj", "two blocks")][:b.size(1, 2)]:
        for samples in b.size([4, 8], [4, 8, 16, 32, 64]):
            info, sums, seconds, memory = form_factors_of(b, model, "--patches", patches, "--samples", samples)
            costs.append((name, info["patches"], samples, f"{info['counts']['shadow_rays'] / 1e6:.1f}", f"{seconds:.1f}", f"{memory:.2f}",
                          f"{rms(v - 1 for v in sums):.1e}"))
    estimators = []
    for words in ["--estimator auto", "--without hidden", "--without free", "--without far", "--estimator area", "--estimator contour",
                  "--estimator point-polygon", "--estimator hemisphere --samples 4096"]:
        info, sums, seconds, _ = form_factors_of(b, MESHES / "two_rooms.obj", "--patches", patches, *words.split())
        estimators.append((f"`{words}`", f"{info['counts']['shadow_rays'] / 1e6:.1f}", f"{seconds:.1f}", f"{rms(v - 1 for v in sums):.1e}",
                           f"{statistics.fmean(sums):.4f}"))
    return [
        "## Samples\n\n`form-factors --no-closure` with reading and writing. In a closed room every row of form factors sums to 1; the last column is the "
        "rms error of the raw row sums.\n\n" + table(["room", "patches", "samples", "rays, M", "CPU s", "GB", "row sums"], costs),
        entries(b),
        "## Estimators\n\nTwo rooms with furniture. Area sampling fails where patches touch.\n\n" +
        table(["options", "rays, M", "CPU s", "row sums: rms error", "mean"], estimators)]


def form_factors_of(b, model, *words):
    folder = b.scratch / "form_factors"
    subprocess.run(["rm", "-rf", folder], check=True)
    _, seconds, memory = b.patchlight("form-factors", model, "--no-closure", "-q", "-o", folder, *words)
    return json.loads((folder / "info.json").read_text()), values_of(folder / "raw_row_sum.npy"), seconds, memory


def entries(b):
    """Entries and their standard errors against a run with many samples and another seed."""
    words = (MESHES / "two_rooms.obj", "--patches", b.size(200, 800), "--without", "far")
    form_factors_of(b, *words, "--samples", b.size(32, 512), "--seed", 77)
    reference = values_of(b.scratch / "form_factors" / "F.npy")
    rows = []
    for samples in b.size([8], [4, 8, 32]):
        form_factors_of(b, *words, "--samples", samples)
        found, errors, areas = (values_of(b.scratch / "form_factors" / f"{name}.npy") for name in ("F", "sampling_error", "area"))
        count = len(areas)
        exchange = sum(areas[i] * sum(reference[i * count:(i + 1) * count]) for i in range(count))
        off = sum(areas[i] * sum(abs(found[k] - reference[k]) for k in range(i * count, (i + 1) * count)) for i in range(count))
        sampled = [(f - r, e) for f, r, e in zip(found, reference, errors) if e != 0]
        ratio = rms([error for error, _ in sampled]) / rms([stated for _, stated in sampled])
        rows.append((samples, f"{off / exchange:.1e}", len(sampled), f"{ratio:.2f}"))
    return ("## Entries and their standard errors\n\nSingle form factors of two rooms with furniture against a run with "
            f"{b.size(32, 512)} samples. L1 is the sum of the absolute differences over the sum of all exchange areas; the "
            "ratio is that of the root mean squares of true and stated errors of all sampled entries.\n\n" +
            table(["samples", "L1", "sampled entries", "true / stated"], rows))


# solvers


def solvers(b):
    text = b.program("benchmark_solvers", MESHES / "two_rooms.obj", *b.size(["small"], []))
    text = re.sub(r"^### ", "## ", text, flags=re.MULTILINE)
    curve = b.program("benchmark_progressive", b.scratch, b.size(400, 4000), MESHES / "cornell_box.obj", MESHES / "two_rooms.obj")
    curve = "## Progressive refinement\n\nThe error of an unfinished solution by the fraction of the rows computed on demand.\n\n" + re.sub(r"^#+ ", "### ", curve, flags=re.MULTILINE)
    return ["Counts are exact; seconds are not. All solvers start from the lamps, with stored form factors. *True error* is that of the reflected light, in "
            "the worst band, against a solution to 1e-11. *Certified* is the bound that the solver prints. Iterations of progressive and overshooting are "
            "shots per patch. The test room is a closed box of 4 x 3 x 2.5 m with two turned blocks, a slab and a small lamp.\n\n" + text, curve]


# pictures


def pictures(b):
    rooms = {"two_rooms": ("0.32,2.41,1.23", "1.29,2.218,1.082", "72"), "cornell_box": ("0.2764,0.2744,-0.7488", "0.2764,0.2744,0", "42")}
    rows = []
    for room, camera in list(rooms.items())[:b.size(1, 2)]:
        model = MESHES / f"{room}.obj"

        def picture(solution, *words):
            file = b.scratch / "picture.exr"
            _, seconds, _ = b.patchlight("render", model, "--solution", solution, "-o", file, "-q", "--size", b.size("64x64", "256x256"), "--camera", *camera, *words)
            return layers(file), seconds

        coarse, fine = b.scratch / f"{room}_coarse.vtp", b.scratch / f"{room}_fine.vtp"
        for file, patches in ((coarse, b.size(300, 2000)), (fine, b.size(600, 16000))):
            b.patchlight("solve", model, "--patches", patches, "-o", file, "-q")
        reference, _ = picture(fine, "--picture-error", b.size("2%", "0.2%"), "--picture-samples", b.size(4, 128))
        least = quantile([v for v in reference["luminance.Y"] if v > 0], 0.9) / 20
        errors = b.size(["5%"], ["10%", "5%", "2%", "1%", "0.5%"])
        settings = [("draft", ["--picture-quality", "draft"])] + [(f"final, {e}", ["--picture-quality", "final", "--picture-error", e]) for e in errors]
        for name, words in settings:
            found, seconds = picture(coarse, *words)
            off = [(found["luminance.Y"][k] - v) / max(v, least) for k, v in enumerate(reference["luminance.Y"]) if reference["patch.id"][k] != 0xffffffff]
            rows.append((room, name, f"{seconds:.1f}", percent(rms(off)), percent(quantile([abs(v) for v in off], 0.5))))
    return [f"## Error and time\n\nImages of {b.size('64 x 64', '256 x 256')} pixels of a solution with {b.size(300, 2000)} patches. The reference is a final image of a "
            f"solution with {b.size(600, 16000)} patches. Errors are relative to the luminance of a pixel, or to a twentieth of the luminance that nine of "
            "ten pixels stay below. CPU seconds are those of `render`, including reading of the solution.\n\n" +
            table(["model", "image", "CPU s", "rms error", "median error"], rows)]


# real-models

REAL_MODELS = {
    "duplex, IFC": "duplex-ifc/Duplex_A.ifc", "open house, IFC": "ifc/IfcOpenHouse_IFC4.ifc",
    "urban house, gbXML": "gbxml-urban-house/Urban_House_MEP.xml", "room with grids, HBJSON": "honeybee-rooms/model_radiance_grid_views.hbjson",
    "patient room, HBJSON": "honeybee-rooms/model_complete_patient_room.hbjson", "kitchen, Mitsuba": "kitchen/kitchen.xml",
    "hall with a door, Mitsuba": "veach-ajar/scene.xml"}


def real_models(b):
    if not b.models:
        return ["The models are not part of this repository; `--models FOLDER` names them.\n"]
    rows = []
    for name, file in list(REAL_MODELS.items()) if b.full else [list(REAL_MODELS.items())[3]]:
        scene = b.scratch / f"{pathlib.Path(file).stem}.toml"
        try:
            b.patchlight("init", b.models / file, "-o", scene)
            report, seconds, memory = b.solve(scene, *b.size(["--patches", 500], []), accept=(0, 3))
        except Failed as error:
            rows.append((name, "-", "-", "-", "-", "-", str(error)))
            continue
        rows.append((name, report["input"]["polygons"], report["mesh"]["patches"], {"tiles": "pairs"}.get(report["plan"]["storage"], report["plan"]["storage"]),
                     f"{seconds:.0f}", f"{memory:.2f}", percent((report["relative_error"] or {}).get("total"))))
    return ["## Cost\n\nEach model is solved with the scene file that `patchlight init` writes for it and default settings" +
            b.size(", but with 500 patches", "") + ".\n\n" + table(["model", "polygons", "patches", "method", "CPU s", "GB", "stated error"], rows)]


# validation


def validation(b):
    # All cases take below a minute; there is no smaller run.
    b.patchlight("selftest", "--json", b.scratch / "selftest.json", accept=(0, 5))
    return [selftest_table(json.loads((b.scratch / "selftest.json").read_text())), surfaces(b)]


def selftest_table(found):
    rows = [(case["case"], f"{case['exact']:.9g}", f"{case['computed']:.9g}", f"{abs(case['computed'] - case['exact']):.1e}",
             f"{case['error_bar']:.1e}", case["exact_from"], "yes" if case["within_bar"] else "**no**") for case in found["cases"]]
    within = sum(case["within_bar"] for case in found["cases"])
    return (f"## Closed forms\n\n`patchlight selftest` compares results with closed-form solutions; {within} of {len(rows)} cases are within their error bars.\n\n" +
            table(["case", "exact", "computed", "difference", "error bar", "source", "within"], rows))


def surfaces(b):
    """Sensors behind panes and sheets and before mirrors, against closed forms and path tracing by another program."""
    folder = b.references and b.references / "surfaces"
    if not folder or not folder.exists():
        return ""
    cases = {"pane_black_clear": "a lamp before and behind a pane, black rooms", "pane_black_coloured": "a colored pane, black rooms",
             "mirror_black": "a lamp before a mirror, black box", "sheet_black": "a lamp before and behind a translucent sheet, black rooms",
             "daylight_black_over": "black room with a pane, overcast sky", "daylight_overcast": "room with a window, overcast sky",
             "daylight_clear_dec": "room with a window, clear sky and sun", "two_rooms_clear": "two rooms with a glass partition"}
    settings = {"pane_black_coloured": ["--set", "pane.transmittance=0.9,0.5,0.2"], "sheet_black": ["--set", "sheet.diffuse_transmittance=0.4"]}
    rows = []
    for case, title in list(cases.items())[:b.size(1, 8)]:
        points = b.scratch / "points.csv"
        b.patchlight("solve", f"{case}.toml", "--patches", b.size(500, 10000), "--points-output", points, *settings.get(case, []), folder=folder)
        with open(points, newline="", encoding="utf-8") as found, open(folder / f"{case}.csv", newline="", encoding="utf-8") as known:
            pairs = [(reading, row) for reading, row in zip(csv.DictReader(found), csv.DictReader(known), strict=True) if row["flag"] == "ok"]
        expected, off, noise = [], [], []
        for reading, row in pairs:
            for band in "rgb":
                exact = row.get("exact_" + band)
                expected.append(float(exact or row["E_" + band]))
                off.append(float(reading["E_" + band]) - expected[-1])
                noise.append(0 if exact else float(row["stderr_" + band]))
        lit = [k for k, value in enumerate(expected) if value > 0]
        mean = statistics.fmean(expected)
        rows.append((title, len(pairs), percent(statistics.median(abs(off[k]) / expected[k] for k in lit)), percent(rms(off) / mean),
                     "closed form" if not any(noise) else percent(statistics.median(noise[k] / expected[k] for k in lit))))
    return ("## Panes, mirrors and sheets\n\nIrradiances at sensors, against closed forms or an unrelated path tracer: median of the relative difference, "
            "rms difference over the mean, and the median standard error of the reference.\n\n" +
            table(["case", "sensors", "median", "rms", "reference"], rows))


PAGES = {
    "accuracy": ("Accuracy", accuracy), "speed": ("Speed", speed), "form-factors": ("Form factors", form_factors), "solvers": ("Solvers", solvers),
    "pictures": ("Images", pictures), "real-models": ("Real models", real_models), "validation": ("Validation", validation)}
CAVEATS = ("One run each, on a machine that may have other work: seconds vary by about a tenth, counts and errors do not. CPU seconds are "
           "those of all threads. Results are the same on any number of threads.")


def processor():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    model = re.search(r"model name\s*: (.*)", text)
    return f"{model[1] if model else 'unknown processor'}, {os.cpu_count()} threads"


def commit():
    def git(*words):
        return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()
    changed = git("status", "--porcelain", "--", "src", "include")
    return (git("rev-parse", "--short", "HEAD") or "unknown") + (" with changes" if changed else "")


def page(b, name, title, sections, seconds):
    version = subprocess.run([b.tool, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    needs = (" --models MODELS" if name == "real-models" else "") + (" --references REFERENCES" if b.references and name in ("accuracy", "validation") else "")
    stamp = table(["version", "commit", "processor", "date", "size", "CPU seconds"],
                  [(version, commit(), processor(), datetime.date.today().isoformat(), "full" if b.full else "small", f"{seconds:.0f}")])
    repeat = ("## How to repeat\n\n```sh\ncmake --preset release -DPATCHLIGHT_BUILD_BENCHMARKS=ON\ncmake --build build --target benchmarks patchlight_tool\n"
              f"tests/benchmarks/tables.py {name}{needs}{'' if b.full else ' --size small'}\n```\n")
    body = "\n".join(section.rstrip() + "\n" for section in sections if section)
    return wrapped(f"# {title}\n\nThis page is generated.\n\n{stamp}\n{CAVEATS}\n\n{body}\n{repeat}")


def wrapped(text):
    """With lines of prose of at most 120 characters."""
    return "".join(line + "\n" if line.startswith(("|", "#")) or len(line) <= 120 else
                   textwrap.fill(line, 120, break_long_words=False, break_on_hyphens=False) + "\n" for line in text.splitlines())


def random_rooms(b):
    """This page is written by its program."""
    words = ["--daylight", 3 * b.rooms // 5, "--lamps", b.rooms - 3 * b.rooms // 5] if b.full else ["--daylight", 1, "--lamps", 1, "--paths", 4096, "--probes", 2]
    file = b.out / "random_rooms.md"
    b.program("benchmark_random_rooms", *words, "--markdown", file)
    file.write_text(wrapped(file.read_text()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", choices=[*PAGES, "random_rooms", "all"], metavar="NAME")
    parser.add_argument("--size", choices=["small", "full"], default="full")
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build/src/patchlight")
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "build/tests/benchmarks")
    parser.add_argument("--models", type=pathlib.Path)
    parser.add_argument("--references", type=pathlib.Path)
    parser.add_argument("--rooms", type=int, default=20, help="of random_rooms; 100 take more than an hour")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    options.out = (options.out or ROOT / ("docs/benchmarks" if options.size == "full" else "build/benchmarks")).resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    total = 0.0
    for name in [*PAGES, "random_rooms"] if "all" in options.names else options.names:
        with tempfile.TemporaryDirectory(prefix="patchlight-tables-") as scratch:
            b = Bench(options, pathlib.Path(scratch))
            try:
                if name == "random_rooms":
                    random_rooms(b)
                else:
                    title, measure = PAGES[name]
                    sections = measure(b)
                    (b.out / f"{name}.md").write_text(page(b, name, title, sections, b.cpu_seconds))
            except Failed as error:
                sys.exit(f"error: {name}: {error}")
        total += b.cpu_seconds
        print(f"{name}: {b.cpu_seconds:.0f} CPU s, wrote {b.out / (name + '.md')}", flush=True)
    print(f"together {total / 60:.1f} CPU minutes")


if __name__ == "__main__":
    main()
