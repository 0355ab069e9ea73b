"""scripts/plot_convergence.py draws plots with matplotlib and prints a message without it."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "plot_convergence.py"
HEADER = "solver,iteration,applications,seconds,relative_residual,error_bound,true_error\n"
NAMES = ["error_by_application", "error_by_iteration", "error_by_second"]
with_matplotlib = unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")


def history(solvers):
    """Solver s reaches 1e-8 in 3 + 19 s iterations; the bound of the first is unknown, and the last error is 0."""
    rows = []
    for s in range(solvers):
        last = 3 + 19 * s
        for k in range(last + 1):
            error = 10 ** (-8 * k / last)
            rows.append(f"solver {s},{k},{k + 1},{0.01 * k},{error},{'inf' if k == 0 else 2 * error},{error}\n")
    return HEADER + "".join(rows) + f"solver 0,{last + 1},{last + 2},9,0,0,0\n"


def run(*words, **variables):
    return subprocess.run([sys.executable, str(SCRIPT), *map(str, words)], capture_output=True, text=True, timeout=600,
                          env=os.environ | variables, check=False)


class PlotConvergenceTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def test_without_matplotlib_it_says_so(self):
        (self.folder / "matplotlib.py").write_text("raise ImportError\n")
        (self.folder / "history.csv").write_text(history(2))
        done = run(self.folder, "-o", self.folder / "out", PYTHONPATH=str(self.folder))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("matplotlib", done.stdout)
        self.assertFalse((self.folder / "out").exists())

    @with_matplotlib
    def test_draws_every_plot_twice_alike(self):
        (self.folder / "history.csv").write_text(history(11))
        for out in ("one", "two"):
            done = run(self.folder, "-o", self.folder / out)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(done.stderr, "")
        for name in NAMES:
            png = (self.folder / "one" / f"{name}.png").read_bytes()
            svg = (self.folder / "one" / f"{name}.svg").read_bytes()
            self.assertTrue(png.startswith(b"\x89PNG\r\n"))
            self.assertTrue(svg.rstrip().endswith(b"</svg>"))
            self.assertEqual(svg, (self.folder / "two" / f"{name}.svg").read_bytes())
        self.assertEqual(len(list((self.folder / "one").iterdir())), 6)

    @with_matplotlib
    def test_says_what_is_wrong_with_the_history(self):
        for text, part in ((None, "No such file"), (HEADER + "cg,0,1,0,1,1,much\n", "much"), ("solver,b\n1,2\n", "iteration")):
            if text is not None:
                (self.folder / "history.csv").write_text(text)
            done = run(self.folder)
            self.assertEqual(done.returncode, 1)
            self.assertIn(part, done.stderr)
            self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main()
