"""A killed run resumes from the rows of rays that it has kept, with the same bits."""
import os
import signal
import subprocess
import time
import unittest

from support import TOOL, ToolTest

# Number of kills of one run; PATCHLIGHT_KILLS raises it.
KILLS = int(os.environ.get("PATCHLIGHT_KILLS", "2"))
PATCHES = 9000
# Rays of a patch: a block of rows takes tenths of a second.
RAYS = 64


class Checkpoint(ToolTest):
    def setUp(self):
        super().setUp()
        grid = [(x / 20, y / 20) for x in range(1, 20) for y in range(1, 20)]
        self.write("spots.txt", "".join(f"{x} {y} 0.5 0 0 1\n" for x, y in grid))
        self.kept = self.folder / "kept"

    @staticmethod
    def command(*options):
        return [TOOL, "solve", "room.obj", "--patches", str(PATCHES), "--rays", str(RAYS), "--method", "rays",
                "--checkpoint", "kept", "--points", "spots.txt", "--points-output", "out.csv", "-o", "out.ply", *options]

    def run_whole(self):
        return subprocess.run(self.command(), cwd=self.folder, check=True, capture_output=True, text=True)

    def results(self):
        """The bytes of both outputs. The .ply has radiances as colors only."""
        return [(self.folder / name).read_bytes() for name in ("out.csv", "out.ply")]

    def blocks(self):
        return sorted(path.name for path in self.kept.glob("rows_*.npy")) if self.kept.exists() else []

    def kill_when(self, blocks, command):
        """Kills the command after it has kept this number of blocks; returns False if the command ended earlier."""
        run = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while run.poll() is None and len(self.blocks()) < blocks:
            time.sleep(0.002)
        run.kill()
        return run.wait() == -signal.SIGKILL

    def test_a_killed_run_goes_on_with_the_same_bits(self):
        self.run_whole()
        whole = self.results()
        (self.folder / "out.csv").unlink()
        for kill in range(KILLS):
            if not self.kill_when(kill + 1, self.command()):
                break
            self.assertFalse((self.folder / "out.csv").exists())
        self.assertGreater(len(self.blocks()), 0)
        done = self.run_whole()
        self.assertRegex(done.stdout + done.stderr, r"note: checkpoint: .*\bkept\b")
        self.assertEqual(self.results(), whole)
        self.assertFalse(self.kept.exists())

    def test_rows_of_other_runs_are_neither_taken_nor_removed(self):
        self.kill_when(1, self.command("--seed", "7"))
        others = self.blocks()
        self.assertGreater(len(others), 0)
        (self.kept / "mine.txt").write_text("mine")
        done = self.run_whole()
        self.assertNotIn("note: checkpoint: ", done.stdout + done.stderr)
        self.assertEqual(self.blocks(), others)
        self.assertTrue((self.kept / "mine.txt").exists())

    def test_what_cannot_be_kept_is_refused(self):
        for options, words in ((["--method", "pairs"], "--method pairs"), (["--form-factors", "there"], "--form-factors")):
            run = subprocess.run([TOOL, "solve", "room.obj", "-o", "out.vtp", "--checkpoint", "kept", *options],
                                 cwd=self.folder, check=False, capture_output=True, text=True)
            self.assertEqual(run.returncode, 1, run.stderr)
            self.assertIn(words, run.stderr)
        self.kept.write_text("a file")
        run = subprocess.run([TOOL, "solve", "room.obj", "-o", "out.vtp", "--checkpoint", "kept"], cwd=self.folder,
                             check=False, capture_output=True, text=True)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("kept", run.stderr)
        self.assertFalse((self.folder / "out.vtp").exists())


if __name__ == "__main__":
    unittest.main()
