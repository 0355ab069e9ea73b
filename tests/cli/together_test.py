"""The files of a run appear together, and simultaneous runs do not mix theirs."""
import json
import subprocess
import unittest
import xml.etree.ElementTree

from support import TOOL, ToolTest, content

OUTPUT = 6


def series(pvd):
    return [pvd.parent / entry.get("file") for entry in xml.etree.ElementTree.parse(pvd).getroot().iter("DataSet")]


class TogetherTest(ToolTest):
    def words(self, brightness, *more):
        return [TOOL, "solve", "room.obj", "-q", "--patches", "60", "--set", f"lamp.exitance={brightness}", "-o", "a.ply",
                "--series", "a.pvd", *more]

    def test_runs_with_one_series(self):
        """The last of ten simultaneous runs wins; at every moment the .pvd names existing files."""
        runs = [subprocess.Popen(self.words(k + 1, "--json", "a.json"), cwd=self.folder, stderr=subprocess.PIPE) for k in range(10)]
        pvd = self.folder / "a.pvd"
        while any(run.poll() is None for run in runs):
            if pvd.exists():
                # The present .pvd names them; at most a later one removes them.
                before = pvd.read_bytes()
                there = [file.exists() for file in series(pvd)]
                self.assertTrue(all(there) or pvd.read_bytes() != before)
        self.assertEqual([run.communicate()[1] for run in runs], 10 * [b""])
        self.assertEqual([run.returncode for run in runs], 10 * [0])
        self.assertEqual(sorted(series(pvd)), sorted((self.folder / "a_series").iterdir()))
        # All files come from one run.
        comment = [line for line in (self.folder / "a.ply").read_bytes().split(b"\n") if b"lamp.exitance" in line][0]
        report = json.loads((self.folder / "a.json").read_text())
        self.assertEqual(comment.decode().removeprefix("comment "), report["command_line"])

    def test_one_that_cannot_be_written_leaves_all_as_they_were(self):
        """The last file exceeds the file size limit of the process."""
        subprocess.run(self.words(1, "--json", "a.json"), cwd=self.folder, check=True)
        before = content(self.folder)
        limit = (self.folder / "a.ply").stat().st_size + 100
        self.assertGreater((self.folder / "a.json").stat().st_size, limit)
        failed = subprocess.run(["prlimit", f"--fsize={limit}", *self.words(2, "--json", "a.json")], cwd=self.folder,
                                capture_output=True, check=False)
        self.assertEqual(failed.returncode, OUTPUT, failed.stderr)
        self.assertEqual(content(self.folder), before)


if __name__ == "__main__":
    unittest.main()
