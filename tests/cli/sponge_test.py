"""Damaged models: every one is solved or refused with a message, and none crashes, hangs or prints a nan.

usage: sponge_test.py [RUNS [SEED [PROCESSES]]]

Takes valid models, damages them at random (bytes flipped, lines cut or doubled, numbers replaced, words exchanged) and runs
`check` and a coarse `solve` on each. PATCHLIGHT_TOOL is the tool; PATCHLIGHT_MESHES the folder of models.
"""
import collections
import concurrent.futures
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

TOOL = os.environ["PATCHLIGHT_TOOL"]
MESHES = pathlib.Path(os.environ["PATCHLIGHT_MESHES"])
SECONDS = 600
SLOW = 30  # seconds; slower runs are listed
MANY_FACES = 100  # a model of more takes half a minute to solve under the sanitizers
SOLVED_OF_THEM = 5  # so only one in five is solved; all are checked
GOOD, INPUT, NOT_CONVERGED, OUT_OF_MEMORY = 0, 2, 3, 4
NUMBERS = ["0", "-0", "1", "-1", "2", "7", "1e-30", "1e30", "-1e30", "1e300", "1e-300", "nan", "-nan", "inf", "-inf", "1e999",
           "99999999999999999999", "-2147483649", "0x10", "1,5", "", "1e", ".", "--1", "+1", "1/2/3", "//", "1e-7", "0.999999999"]
WORDS = ["v", "f", "usemtl", "mtllib", "newmtl", "Kd", "Ke", "g", "o", "l", "p", "vt", "#", "\\", "map_Kd", "d", "s"]


def flip_bytes(data, chance):
    damaged = bytearray(data)
    for _ in range(chance.choice((1, 1, 2, 5, 50))):
        damaged[chance.randrange(len(damaged))] = chance.randrange(256)
    return bytes(damaged)


def cut_lines(data, chance):
    lines = data.split(b"\n")
    for _ in range(chance.choice((1, 2, 10))):
        begin = chance.randrange(len(lines))
        del lines[begin:begin + chance.choice((1, 1, 3, 20))]
        if not lines:
            return b""
    return b"\n".join(lines)


def mix_lines(data, chance):
    lines = data.split(b"\n")
    for _ in range(chance.choice((1, 3, 30))):
        lines.insert(chance.randrange(len(lines)), lines[chance.randrange(len(lines))])
    return b"\n".join(lines)


def cut_end(data, chance):
    return data[:chance.randrange(len(data))]


def replace_numbers(data, chance):
    found = list(re.finditer(rb"[-+0-9.eE]+", data))
    for match in sorted(chance.sample(found, min(len(found), chance.choice((1, 1, 3, 10)))), key=lambda m: -m.start()):
        data = data[:match.start()] + chance.choice(NUMBERS).encode() + data[match.end():]
    return data


def exchange_corners(data, chance):
    """Other vertices for some faces: bent, crossing, doubled and empty ones.

    Many faces with very many corners would give thousands of patches each, so at most five of them change at once."""
    lines = data.split(b"\n")
    faces = [k for k, line in enumerate(lines) if line.startswith(b"f ")]
    vertices = sum(line.startswith(b"v ") for line in lines)
    count = min(len(faces), chance.choice((1, 5, 20)))
    corners = (3, 4, 5, 8, 30) if count <= 5 else (3, 4, 5, 8)
    for k in chance.sample(faces, count):
        lines[k] = b"f " + b" ".join(b"%d" % chance.randrange(1, vertices + 1) for _ in range(chance.choice(corners)))
    return b"\n".join(lines)


def exchange_words(data, chance):
    words = re.split(rb"(\s+)", data)
    for _ in range(chance.choice((1, 5))):
        words[chance.randrange(len(words))] = chance.choice(WORDS).encode()
    return b"".join(words)


def damaged(model, chance):
    """The files of a model, one of them damaged."""
    files = {path.name: path.read_bytes() for path in (model, model.with_suffix(".mtl"))}
    name = model.name if chance.random() < 0.75 else model.with_suffix(".mtl").name
    tools = [flip_bytes, cut_lines, mix_lines, cut_end, replace_numbers, exchange_words]
    if name == model.name:
        tools += [exchange_corners, exchange_corners]
    for _ in range(chance.choice((1, 1, 2))):
        if files[name]:
            files[name] = chance.choice(tools)(files[name], chance)
    return files


def complaint(done, command):
    """The fault of a run; None if there is none."""
    output = done.stdout + done.stderr
    if done.returncode not in (GOOD, INPUT, NOT_CONVERGED, OUT_OF_MEMORY):
        return f"exit code {done.returncode}"
    if command == "check" and done.returncode not in (GOOD, INPUT):
        return f"exit code {done.returncode}"
    if done.returncode != GOOD and not re.search(r"^patchlight: \w+: .{20}", done.stderr, re.MULTILINE):
        return "no message"
    # A message may quote the model.
    unquoted = re.sub(r"'[^'\n]*'", "", output)
    if done.returncode == GOOD and re.search(r"(?<![\w.])-?nan(?![\w.])", unquoted):
        return "prints a nan"
    return None


def run(folder, name, command):
    arguments = {"check": ["check", name, "--problems", "problems.vtp", "--json", "check.json"],
                 "solve": ["solve", name, "--patches", "60", "--samples", "4", "--threads", "1",
                           "--json", "report.json"]}[command]
    try:
        done = subprocess.run([TOOL, *arguments], cwd=folder, capture_output=True, timeout=SECONDS, check=False,
                              encoding="utf-8", errors="replace")
    except subprocess.TimeoutExpired:
        return None, f"still running after {SECONDS} s"
    return done, complaint(done, command)


def try_model(seed, number):
    """Damages one model and runs the commands on it; returns the exit codes by command and the number of failures."""
    chance = random.Random(seed * 1_000_003 + number)
    model = chance.choice(sorted(MESHES.glob("*.obj")))
    codes = collections.Counter()
    failures = 0
    with tempfile.TemporaryDirectory(prefix="patchlight-sponge-") as name:
        folder = pathlib.Path(name)
        files = damaged(model, chance)
        for file, data in files.items():
            (folder / file).write_bytes(data)
        is_large = model.read_bytes().count(b"\nf ") > MANY_FACES
        commands = ("check",) if is_large and number % SOLVED_OF_THEM else ("check", "solve")
        for command in commands:
            begin = time.monotonic()
            done, wrong = run(folder, model.name, command)
            seconds = time.monotonic() - begin
            codes[command, done.returncode if done else None] += 1
            if not wrong and seconds < SLOW:
                continue
            print(f"run {number} (seed {seed}), {model.name}, {command}, {seconds:.0f} s: {wrong or 'slow'}", flush=True)
            for file, data in files.items():
                pathlib.Path(f"sponge-{seed}-{number}-{file}").write_bytes(data)
            if wrong:
                failures += 1
                print(done.stderr[-2000:] if done else "", flush=True)
    return codes, failures


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 40
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    processes = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    codes = collections.Counter()
    failures = 0
    with concurrent.futures.ThreadPoolExecutor(processes) as pool:
        for more_codes, more_failures in pool.map(lambda number: try_model(seed, number), range(runs)):
            codes += more_codes
            failures += more_failures
    for (command, code), count in sorted(codes.items(), key=str):
        print(f"{command}: exit code {code}: {count}")
    print(f"{failures} failures in {runs} damaged models")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
