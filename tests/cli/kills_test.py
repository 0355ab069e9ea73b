"""A run that is killed before any call that changes a folder leaves every output either old or complete and new."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import unittest

from support import MATERIALS, ROOM, TOOL, ToolTest

KILL = os.environ.get("PATCHLIGHT_KILL_AT_CALL")
# In the order in which they are renamed.
FILES = ("out.vtp", "spots.csv", "out.json")
# Many times the calls of a run: ends the search if something is wrong.
MOST_CALLS = 400


def solve(light):
    """A command that writes three files, from which the test can read the brightness of the lamp."""
    return [TOOL, "solve", "room.obj", "--quiet", "--patches", "30", "--set", f"lamp.exitance={light}", "-o", "out.vtp",
            "--json", "out.json", "--points", "spots.txt", "--points-output", "spots.csv"]


def form_factors(samples):
    return [TOOL, "form-factors", "room.obj", "--patches", "30", "--samples", samples, "-o", "stored"]


@unittest.skipUnless(KILL, "sanitizers want to be loaded first")
class Kills(ToolTest):
    def setUp(self):
        super().setUp()
        for name, text in (("room.obj", ROOM), ("room.mtl", MATERIALS), ("spots.txt", "0.1 0.1 1.5 0 0 1\n")):
            (self.folder / name).write_text(text)

    def run_whole(self, command):
        subprocess.run(command, cwd=self.folder, check=True, capture_output=True)

    def killed_runs(self, command):
        """Kills the command before its first call, its second and so on, until a run ends by itself."""
        for call in range(1, MOST_CALLS):
            done = subprocess.run(command, cwd=self.folder, capture_output=True, check=False,
                                  env={**os.environ, "LD_PRELOAD": KILL, "KILL_AT_CALL": str(call)})
            if done.returncode == 0:
                return
            self.assertEqual(done.returncode, -signal.SIGKILL, done.stderr)
            yield call
        self.fail(f"more than {MOST_CALLS} calls")

    def left(self):
        return list(self.folder.glob(".patchlight-*"))

    def copy_of_folder(self):
        """A copy of all files in another folder."""
        copy = self.empty_folder()
        shutil.copytree(self.folder, copy, dirs_exist_ok=True)
        return copy

    def empty_folder(self):
        folder = tempfile.TemporaryDirectory(prefix="patchlight-aside-")
        self.addCleanup(folder.cleanup)
        return pathlib.Path(folder.name)

    def put_back(self, copy, aside):
        """Restores all files from the copy. Moves the leftovers of a killed run to `aside`."""
        for path in self.left():
            shutil.move(path, aside)
        shutil.rmtree(self.folder)
        shutil.copytree(copy, self.folder)

    def assert_next_run_removes_what_is_left(self, aside, command):
        """One run removes the leftovers of all killed runs."""
        shutil.copytree(aside, self.folder, dirs_exist_ok=True)
        self.assertGreater(len(self.left()), 1)
        self.run_whole(command)
        self.assertEqual(self.left(), [])

    def test_files_are_old_or_new_and_renamed_in_one_go(self):
        self.run_whole(solve("1,1,1"))
        facts = {"new": {}, "old": {}}
        for age, light in (("new", "3,3,3"), ("old", "2,2,2")):
            self.run_whole(solve(light))
            facts[age] = {name: self.fact(name) for name in FILES}
        old, aside = self.copy_of_folder(), self.empty_folder()
        found = set()
        for call in self.killed_runs(solve("3,3,3")):
            ages = []
            for name in FILES:
                now = self.fact(name)
                self.assertIn(now, (facts["old"][name], facts["new"][name]), f"{name} at call {call}")
                ages.append("new" if now == facts["new"][name] else "old")
            found.add(tuple(ages))
            self.put_back(old, aside)
        # Before, between and after the renames, which are consecutive.
        self.assertEqual(found, {("old",) * 3, ("new", "old", "old"), ("new", "new", "old"), ("new",) * 3})
        self.assert_next_run_removes_what_is_left(aside, solve("2,2,2"))

    def fact(self, name):
        """A content of the file that depends on the brightness of the lamp."""
        data = (self.folder / name).read_bytes()
        if name == "out.vtp":
            self.assertTrue(data.rstrip().endswith(b"</VTKFile>"))
            return self.range_of(data)
        return data if name == "spots.csv" else json.loads(data)["command_line"]

    @staticmethod
    def range_of(data):
        """The largest radiance according to the header."""
        return re.search(rb'Name="radiance"[^>]*RangeMax="([0-9.]+)"', data)[1]

    def test_a_folder_is_old_or_new(self):
        facts = []
        for samples in ("8", "4"):
            self.run_whole(form_factors(samples))
            facts.append(self.bytes_of_folder())
        old, aside = self.copy_of_folder(), self.empty_folder()
        ages = set()
        for call in self.killed_runs(form_factors("8")):
            self.assertIn(self.bytes_of_folder(), facts, f"at call {call}")
            ages.add(facts.index(self.bytes_of_folder()))
            self.put_back(old, aside)
        self.assertEqual(ages, {0, 1})
        self.assert_next_run_removes_what_is_left(aside, form_factors("4"))

    def bytes_of_folder(self):
        return {file.name: file.read_bytes() for file in (self.folder / "stored").iterdir() if file.suffix == ".npy"}


if __name__ == "__main__":
    unittest.main()
