"""Guarantees about files: old or complete and new in all cases; any name; any number of threads."""
import json
import os
import random
import re
import resource
import signal
import struct
import subprocess
import time
import unittest
import xml.etree.ElementTree

from support import MATERIALS, ROOM, TOOL, ToolTest, content, is_one_message

OUTPUT = 6
OLD = b"an older result"
NAMES = ("out.vtp", "out.ply", "out.glb", "out.pvd", "out.png", "out.json", "spots.csv")


def arguments(model="room.obj", picture=True):
    words = [TOOL, "solve", model, "--quiet", "--patches", "100", "-o", "out.vtp", "-o", "out.ply", "-o", "out.glb",
             "--series", "out.pvd", "--json", "out.json", "--points", "spots.txt", "--points-output", "spots.csv"]
    return words + ["--picture", "out.png"] if picture else words


def whole_vtp(data):
    """Checks header and end; the appended data match the offsets of the arrays and the sizes of their blocks."""
    begin = data.index(b"_", data.index(b"<AppendedData")) + 1
    last = max(int(offset) for offset in re.findall(rb'offset="(\d+)"', data[:begin]))
    # Per array: number of blocks, size of a block, size of the last one, compressed sizes; then the blocks.
    blocks = struct.unpack_from("<Q", data, begin + last)[0]
    sizes = struct.unpack_from(f"<{blocks}Q", data, begin + last + 24)
    end = begin + last + 8 * (3 + blocks) + sum(sizes)
    return data[end:].split() == [b"</AppendedData>", b"</VTKFile>"]


def whole_ply(data):
    header, body = data.split(b"end_header\n", 1)
    vertices, faces = (int(re.search(rb"element %s (\d+)" % name, header)[1]) for name in (b"vertex", b"face"))
    at = 27 * vertices  # three doubles and three bytes each
    for _ in range(faces):
        at += 1 + 4 * body[at]
    return at == len(body)


def whole_glb(data):
    return data[:4] == b"glTF" and struct.unpack_from("<I", data, 8)[0] == len(data)


def whole_png(data):
    return data.startswith(b"\x89PNG") and data[-8:-4] == b"IEND"


def whole_csv(data):
    commas = [line.count(b",") for line in data.splitlines()]
    return len(commas) == 2 and commas[0] == commas[1] >= 12


def whole_json(data):
    return "solution" in json.loads(data)


def series(pvd):
    """The .vtp files that a .pvd names."""
    entries = xml.etree.ElementTree.parse(pvd).getroot().iter("DataSet")
    return [pvd.parent / entry.get("file") for entry in entries]


WHOLE = {".vtp": whole_vtp, ".ply": whole_ply, ".glb": whole_glb, ".png": whole_png, ".csv": whole_csv,
         ".json": whole_json}


class PromisesTest(ToolTest):
    def setUp(self):
        super().setUp()
        self.write("spots.txt", "0 0 0.5 0 0 1\n")

    def put_old(self):
        for name in NAMES:
            (self.folder / name).write_bytes(OLD)

    def assert_old_or_whole(self, path):
        """Returns True if the file is new."""
        if path.suffix != ".pvd":
            data = path.read_bytes()
            self.assertTrue(data == OLD or WHOLE[path.suffix](data), f"{path.name} is neither old nor whole")
            return data != OLD
        if path.read_bytes() == OLD:
            return False
        files = series(path)
        self.assertGreater(len(files), 2)
        for file in files:
            self.assertTrue(whole_vtp(file.read_bytes()), file)
        return True

    def test_killed_at_any_moment(self):
        """Kills at twenty moments; without a picture, which takes longest, writing is much of the run."""
        moments = random.Random(6502)
        for picture, count in ((False, 17), (True, 3)):
            self.run_and_kill(picture, moments, count)

        # The next run removes the temporary files of killed runs.
        left = self.folder / ".patchlight-1-0.vtp"
        left.write_bytes(b"half")
        subprocess.run(arguments(), cwd=self.folder, check=True, capture_output=True)
        self.assertEqual([path.name for path in self.folder.rglob(".patchlight-*")], [])
        self.assertEqual(sorted(series(self.folder / "out.pvd")), sorted((self.folder / "out_series").iterdir()))

    def run_and_kill(self, picture, moments, count):
        """Kills `count` runs at random moments.

        If a run ends before its moment, later moments are drawn below that one, so that runs are killed on a machine
        under any load."""
        started = time.monotonic()
        subprocess.run(arguments(picture=picture), cwd=self.folder, check=True, capture_output=True)
        duration = time.monotonic() - started
        written = [name for name in NAMES if picture or not name.endswith(".png")]
        self.assertTrue(all(self.assert_old_or_whole(self.folder / name) for name in written))
        killed = 0
        while killed < count:
            self.put_old()
            moment = moments.uniform(0, duration)
            with subprocess.Popen(arguments(picture=picture), cwd=self.folder) as process:
                time.sleep(moment)
                process.kill()
                was_killed = process.wait() == -signal.SIGKILL
            killed += was_killed
            duration = duration if was_killed else moment
            for name in written:
                self.assert_old_or_whole(self.folder / name)

    def assert_full_disk_is_refused(self, folder, **run):
        before = content(folder)
        done = subprocess.run(arguments(self.folder / "room.obj"), cwd=folder, capture_output=True, text=True,
                              check=False, **run)
        self.assertEqual(done.returncode, OUTPUT, done.stderr)
        self.assertTrue(is_one_message(done.stderr), done.stderr)
        self.assertIn("out.vtp", done.stderr)
        self.assertEqual(content(folder), before)

    def test_file_that_cannot_grow(self):
        """Files may have 2000 bytes, and the result does not fit."""
        self.put_old()
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
        self.assert_full_disk_is_refused(self.folder, preexec_fn=limit)

    def test_full_disk(self):
        """A file system in memory with a few pages."""
        disk = self.folder / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=48k", "tmpfs", disk], capture_output=True,
                                 check=False)
        if mounted.returncode != 0:
            self.skipTest("only the superuser may mount a file system")
        try:
            for name in (*NAMES, "spots.txt"):
                (disk / name).write_bytes((self.folder / name).read_bytes() if name == "spots.txt" else OLD)
            (disk / "filler").write_bytes(bytes(12 << 10))
            self.assert_full_disk_is_refused(disk)
        finally:
            subprocess.run(["umount", disk], check=True)

    def test_any_name(self):
        """Blanks, letters of other scripts, quotes, bytes that are not UTF-8."""
        for name in ("B\u00fcro 3 \u2013 \u00e9t\u00e9", "\u30e2\u30c7\u30eb", "it's <a> & \"b\"", os.fsdecode(b"caf\xe9")):
            with self.subTest(name):
                folder = self.folder / name
                folder.mkdir()
                model = folder / (name + ".obj")
                model.write_text(ROOM.replace("room.mtl", name + ".mtl") if name.isprintable() else ROOM)
                for materials in (name + ".mtl", "room.mtl"):
                    (folder / materials).write_text(MATERIALS)
                outputs = [folder / (name + suffix) for suffix in (".vtp", ".ply", ".glb", ".pvd", ".png", ".json", ".csv")]
                if not name.isprintable():  # a .pvd is XML and can name UTF-8 only
                    outputs[3] = folder / "plain.pvd"
                vtp, ply, glb, pvd, png, report, csv = outputs
                done = subprocess.run(
                    [TOOL, "solve", model, "--patches", "60", "-o", vtp, "-o", ply, "-o", glb, "--series", pvd, "--json",
                     report, "--picture", png, "--size", "80x60", "--points", "spots.txt", "--points-output", csv],
                    cwd=self.folder, capture_output=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                for output in outputs:
                    self.assertTrue(self.assert_old_or_whole(output))

    def test_more_threads_than_processors(self):
        for threads in (1, 8 * (os.cpu_count() or 1)):
            done = self.run_tool("solve", "room.obj", "--patches", 200, "--threads", threads, "-o", f"{threads}.ply",
                                 "--quiet")
            self.assertEqual((done.returncode, done.stderr), (0, ""))
        one, many = (path.read_bytes().split(b"end_header\n")[1] for path in sorted(self.folder.glob("*.ply")))
        self.assertEqual(one, many)

    def test_format_follows_the_extension(self):
        """The three formats hold the same patches."""
        done = self.run_tool("solve", "room.obj", "--patches", 200, "-o", "a.vtp", "-o", "a.ply", "-o", "a.glb")
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in ("a.vtp", "a.ply", "a.glb"):
            self.assertIn(name, done.stdout)
            self.assertTrue(self.assert_old_or_whole(self.folder / name))
        faces = re.search(rb"element face (\d+)", (self.folder / "a.ply").read_bytes())[1]
        self.assertIn(b'NumberOfPolys="' + faces + b'"', (self.folder / "a.vtp").read_bytes())

    def test_series_has_every_iteration_of_the_report(self):
        for solver in ((), ("--solver", "gauss-seidel")):
            done = self.run_tool("solve", "room.obj", "--patches", 100, "--series", "a.pvd", "--json", "a.json", *solver)
            self.assertEqual(done.returncode, 0, done.stderr)
            solution = json.loads((self.folder / "a.json").read_text())["solution"]
            self.assertEqual(solution["solver"], solver[1] if solver else "jacobi")
            files = series(self.folder / "a.pvd")
            self.assertEqual(len(files), len(solution["iterations"]))
            self.assertEqual(sorted(files), sorted((self.folder / "a_series").iterdir()))


if __name__ == "__main__":
    unittest.main()
