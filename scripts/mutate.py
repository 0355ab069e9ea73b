#!/usr/bin/env python3
"""Runs the tool on damaged files of every kind it reads, and reports forbidden behavior.

usage: scripts/mutate.py TOOL [--runs N] [--first N] [--seconds S] [--seed N] [--jobs N] [--kinds A,B,...]
       [--commands A,B,...] [--memory GB] [--keep FOLDER]

Good files are damaged (bits turned, parts cut out, doubled or swapped, numbers replaced by hostile ones, words by
others of the file, brackets piled up) and given to check, plan, solve, relight or render. A run is bad if a signal ends
the tool; it takes over 20 s of the processor or never ends; its exit code is not documented, or 70, which
stands for a defect; it fails without a message; a library writes to the terminal; it succeeds and prints a nan. The tool
may be any build. --commands check,plan tries the readers alone, in a fraction of the time. --memory limits the address
space (default: 4; 0: no limit, for sanitizers); IFC files are read by Node.js, which reserves more and has no limit. Run
number k of a seed is always the same, so that many can be made in pieces, each from --first on. A line every 500 runs
shows the progress. Bad inputs are kept in FOLDER (default: mutate_found).
"""
import argparse
import concurrent.futures
import os
import pathlib
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

TESTS = pathlib.Path(__file__).resolve().parent.parent / "tests"
CORPUS = TESTS / "fuzz" / "corpus"
sys.path.insert(0, str(TESTS / "cli"))
import room  # noqa: E402  the folder of the tests is no package

DOCUMENTED = {0, 1, 2, 3, 4, 5, 6, 129, 130, 143}
PATIENCE = 20  # seconds of the processor
WAITING = 600  # seconds by the clock, for a run that waits for what never comes; the machine may be busy
# Sanitizers end a run with exit code 1 by default, which is documented.
ENVIRONMENT = {"ASAN_OPTIONS": "abort_on_error=1:detect_leaks=0:allocator_may_return_null=1",
               "UBSAN_OPTIONS": "abort_on_error=1:print_stacktrace=1", **os.environ}

# With a group and a picture.
ROOM = room.ROOM.replace("usemtl white", "g walls\nusemtl white")
MATERIALS = room.MATERIALS.replace("Kd 0.7 0.6 0.5", "Kd 0.7 0.6 0.5\nmap_Kd wood.png")
IES = """IESNA:LM-63-2002
[TEST] none
TILT=NONE
1 1000 1 5 3 1 2 0.1 0.2 0
1 1 100
0 22.5 45 67.5 90
0 45 90
300 290 200 90 0
300 280 190 80 0
300 270 180 70 0
"""
EPW = ("LOCATION,Here,-,-,-,1,50.0,10.0,1.0,100.0\nDESIGN CONDITIONS,0\n" +
       "".join(f"2001,6,21,{hour},60,A,20,10,50,100000,1000,1400,300,{50 * hour},{20 * hour},700,150,100,900,180,2\n"
               for hour in range(8, 16)))
POINTS = "# x y z nx ny nz\n0 0 0.5 0 0 1\n0.5,0.5,0.5,0,0,2\n-0.6 0.5 1 1 0 0 # side\n"
SCENE = """unit = "m"
up = "z"
[[model]]
file = "room.obj"
scale = [1, 1, -1]
rotate = [{ axis = "z", degrees = 90 }, { axis = [1, 0, 0], degrees = 180 }]
translate = [0.1, 0, 0]
[[material]]
name = "wh*"
reflectance = [0.5, 0.4, 0.3]
[[sensors]]
name = "desk"
corner = [-0.5, -0.5, 0.7]
edges = [[1, 0, 0], [0, 1, 0]]
spacing = 1
[[sensors]]
points = [[0, 0, 0.3, 0, 0, 1]]
[[sensors]]
file = "spots.pts"
[[sensors]]
floor = "walls"
height = 0.2
spacing = 1
[[camera]]
name = "door"
eye = [0.8, 0, 1]
target = [0, 0, 1]
field_of_view = 60
[[luminaire]]
kind = "ies"
file = "lamp.ies"
position = [0, 0, 1.5]
[[luminaire]]
kind = "spot"
lumens = 500
beam_angle = 30
field_angle = 50
position = [0.2, 0, 1.5]
aim = [0, 0, -1]
[[luminaire]]
kind = "sphere"
watts = [1, 2, 3]
radius = 0.05
position = [0.3, 0.3, 1]
"""
SKIES = ("""[weather]
file = "w.epw"
month = 6
day = 21
hour = 11
[ground]
reflectance = 0.2
""", """[site]
latitude = 50.0
longitude = 10.0
[sun]
time = 2024-06-21T12:00:00Z
irradiance = 500
[sky]
kind = "clear"
illuminance = 10000
""")
PART = "void plastic grey 0 0 5 .5 .5 .5 0 0\ngrey polygon p 0 0 9 0 0 0 .1 0 0 0 .1 .1\n"
HOSTILE = [b"0", b"-1", b"1", b"1.0000001", b"1e-300", b"1e15", b"1e19", b"1e39", b"1e300", b"-1e300", b"1e999", b"nan", b"inf",
           b"2147483648", b"4294967295", b"18446744073709551616", b"-2147483649", b"", b"0x10", b"1,5", b"/", b"\\", b"#",
           b'"', b"'''", b"[", b"{", b"}", b"\x00", b"\x1b[2J", b"\xff\xfe", b"\n\n", b"../", b"/dev/zero", b"/dev/stdin",
           b".a", b"%s%n"]
MESSAGE = re.compile(rb"^patchlight: \w+: .{12}", re.MULTILINE)
# The tool begins each line itself; sanitizers and libraries do not.
FOREIGN = re.compile(rb"^(?!patchlight: |hint: |[ ]|$).*|.*json\.exception.*", re.MULTILINE)
NAN = re.compile(rb"(?<![\w.])-?nan(?![\w.])")
QUOTED = re.compile(rb"'[^'\n]*'")  # a message may quote the file
NUMBER = re.compile(rb"[-+]?[0-9]+\.?[0-9]*(?:[eE][-+]?[0-9]+)?")


def npy_folder(tool, folder):
    """A folder of form factors, made by the tool itself; its files by name."""
    with tempfile.TemporaryDirectory() as place:
        for name, text in (("room.obj", ROOM), ("room.mtl", MATERIALS)):
            (pathlib.Path(place) / name).write_text(text)
        words = [tool, "form-factors", "room.obj", "--patches", "40", "--no-closure", "-q", "-o", "F"]
        subprocess.run(words, cwd=place, check=True, capture_output=True)
        shutil.copytree(pathlib.Path(place) / "F", folder)


def solution(tool):
    """A .vtp file, made by the tool itself."""
    with tempfile.TemporaryDirectory() as place:
        for name, text in (("room.obj", ROOM), ("room.mtl", MATERIALS)):
            (pathlib.Path(place) / name).write_text(text)
        words = [tool, "solve", "room.obj", "--patches", "40", "-q", "-o", "s.vtp"]
        subprocess.run(words, cwd=place, check=True, capture_output=True)
        return (pathlib.Path(place) / "s.vtp").read_bytes()


def seeds(tool, scratch, wanted):
    """For every kind the good files, the one that is damaged first, and those of the wanted commands that read them.
    Kinds that none of these commands reads are left out."""
    everything = {"room.obj": ROOM.encode(), "room.mtl": MATERIALS.encode(), "lamp.ies": IES.encode(), "w.epw": EPW.encode(),
                  "spots.pts": POINTS.encode(), "scene.toml": (SCENE + SKIES[0]).encode(), "part.rad": PART.encode()}
    solve = ["--patches", "30", "--memory", "1GB", "-q", "-o", "out.ply"]
    cases = {}
    for kind, name in (("toml", "scene.toml"), ("ies", "lamp.ies"), ("epw", "w.epw"), ("mtl", "room.mtl"),
                       ("points", "spots.pts")):
        model = "room.obj" if kind == "mtl" else "scene.toml"
        extra = ["--points", "spots.pts"] if kind == "points" else []
        cases[kind] = [({**everything, "scene.toml": (SCENE + sky).encode()}, name,
                        [["check", model], ["plan", model, "--patches", "30"], ["solve", model, *extra, *solve]])
                       for sky in SKIES[:1 if kind == "epw" else 2]]
    for folder in sorted(CORPUS.iterdir()):
        kind = folder.name
        if kind in ("mesh", "mtl", "toml", "ies", "epw", "npy", "pts", "vtp", "json"):
            continue
        cases[kind] = []
        for file in sorted(folder.iterdir()):
            name = "model." + kind
            lamp = ["--set", "*.exitance=1"]
            cases[kind].append(({**everything, name: file.read_bytes()}, name,
                                [["check", name], ["plan", name, "--patches", "30", *lamp], ["solve", name, *lamp, *solve]]))
    cases["obj"].append((everything, "room.obj", [["check", "room.obj"], ["solve", "room.obj", *solve]]))
    if "relight" in wanted:
        npy_folder(tool, scratch / "F")
        files = {f"F/{file.name}": file.read_bytes() for file in sorted((scratch / "F").iterdir())}
        cases["npy"] = [(files, name, [["relight", "F", "-q", "-o", "out.ply"]]) for name in files if not name.endswith(".vtp")]
    if "render" in wanted:
        render = ["render", "room.obj", "--solution", "s.vtp", "-o", "out.png", "--size", "16x16", "-q"]
        cases["vtp"] = [({**everything, "s.vtp": solution(tool)}, "s.vtp", [render])]
    cases = {kind: [(files, name, [words for words in commands if words[0] in wanted]) for files, name, commands in some]
             for kind, some in cases.items()}
    cases = {kind: [case for case in some if case[2]] for kind, some in cases.items()}
    return {kind: some for kind, some in cases.items() if some}


def damaged(data, chance):
    """One to four kinds of damage."""
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        kind = chance.randrange(10)
        at = chance.randrange(len(data) + 1)
        length = min(len(data) - at, chance.choice((1, 2, 4, 8, 40, 400)))
        numbers = list(NUMBER.finditer(data[:20000])) if kind in (0, 1, 2) else []
        if numbers:
            where = chance.choice(numbers)
            data = data[:where.start()] + chance.choice(HOSTILE) + data[where.end():]
        elif kind == 3:
            data = data[:at] + data[at + length:]
        elif kind == 4:
            data = data[:at] + data[at:at + length] * chance.choice((2, 3, 50)) + data[at + length:]
        elif kind == 5:
            data = data[:at] + chance.choice(HOSTILE) * chance.choice((1, 1, 3, 3000)) + data[at:]
        elif kind == 6 and data:
            at = min(at, len(data) - 1)
            data = data[:at] + bytes([data[at] ^ (1 << chance.randrange(8))]) + data[at + 1:]
        elif kind == 9 and len(data) < 1_000_000:
            words = re.split(rb"(\s+)", data)
            for _ in range(chance.choice((1, 5))):
                words[chance.randrange(len(words))] = chance.choice(words)
            data = b"".join(words)
        elif kind == 7:
            data = data[:at] + struct.pack("<I", chance.choice((0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF))) + data[at + 4:]
        else:
            data = data[:at]
    return data


def fault_of(code, said, printed):
    """The fault of a run that has ended; None when there is none."""
    if code in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"over {PATIENCE} s"
    if code not in DOCUMENTED:
        return f"exit code {code}"
    if FOREIGN.search(said):
        return f"text of a library: {FOREIGN.search(said)[0][:80]!r}"
    if code == 0:
        return "prints a nan" if NAN.search(printed + QUOTED.sub(b"", said)) else None
    return None if MESSAGE.search(said) else "no message"


def run_one(options, cases, kinds, number):
    """Run `number`: nothing when it is good, else its fault."""
    seed = options.seed
    chance = random.Random(f"{seed} {number}")
    kind = kinds[number % len(kinds)]
    limits = [f"--cpu={PATIENCE}"]
    if options.memory > 0 and kind != "ifc":
        limits.append(f"--as={options.memory * 10**9:.0f}")
    files, name, commands = chance.choice(cases[kind])
    words = chance.choice(commands)
    with tempfile.TemporaryDirectory(prefix="patchlight-mutate-") as folder:
        for file, data in files.items():
            path = pathlib.Path(folder) / file
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(damaged(data, chance) if file == name else data)
        try:
            one_thread = [] if words[0] == "check" else ["--threads", "1"]
            done = subprocess.run(["prlimit", *limits, options.tool, *words, *one_thread], cwd=folder, check=False,
                                  stdin=subprocess.DEVNULL, capture_output=True, timeout=WAITING, env=ENVIRONMENT)
            fault = fault_of(done.returncode, done.stderr, done.stdout)
            said = done.stderr[-2000:].decode(errors="replace")
        except subprocess.TimeoutExpired:
            fault, said = f"no end after {WAITING} s", ""
        if fault is None:
            return None
        place = options.keep / f"{kind}-{seed}-{number}"
        shutil.copytree(folder, place, dirs_exist_ok=True)
    return f"run {number}, {kind}: {fault}: {' '.join(words)}; kept in {place}\n{said}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=os.path.abspath)
    parser.add_argument("--runs", type=int, default=1_000_000_000, help="default: until --seconds are over")
    parser.add_argument("--first", type=int, default=0, help="number of the first run")
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--kinds", type=lambda text: text.split(","))
    parser.add_argument("--commands", type=lambda text: text.split(","), default=["check", "plan", "solve", "relight", "render"])
    parser.add_argument("--memory", type=float, default=4, metavar="GB")
    parser.add_argument("--keep", type=pathlib.Path, default=pathlib.Path("mutate_found"))
    options = parser.parse_args()
    begin = time.monotonic()
    bad, count = [], 0
    with tempfile.TemporaryDirectory(prefix="patchlight-mutate-") as scratch:
        cases = seeds(options.tool, pathlib.Path(scratch), options.commands)
        kinds = options.kinds or sorted(cases)
        if not kinds or not set(kinds) <= set(cases):
            parser.error(f"the commands read these kinds: {', '.join(sorted(cases)) or 'none'}")
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            numbers = iter(range(options.first, options.first + options.runs))
            pending = set()
            while True:
                while len(pending) < 2 * options.jobs and time.monotonic() - begin < options.seconds:
                    number = next(numbers, None)
                    if number is None:
                        break
                    pending.add(pool.submit(run_one, options, cases, kinds, number))
                if not pending:
                    break
                done, pending = concurrent.futures.wait(pending, return_when=concurrent.futures.FIRST_COMPLETED)
                for future in done:
                    count += 1
                    if count % 500 == 0:
                        print(f"mutate: {count} runs in {time.monotonic() - begin:.0f} s, {len(bad)} bad", flush=True)
                    if future.result():
                        bad.append(future.result())
                        print(future.result(), file=sys.stderr, flush=True)
    since = f" from {options.first} on" if options.first else ""
    print(f"mutate: {count} runs{since} of seed {options.seed} over {', '.join(kinds)} in {time.monotonic() - begin:.0f} s, "
          f"{len(bad)} bad")
    return 1 if bad or count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
