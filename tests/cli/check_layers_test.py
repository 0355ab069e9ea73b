"""The layer check finds forbidden includes."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "check_layers.py"

LAYERS = """[modules]
base:
mesh: base
[libraries]
Eigen/: base mesh
embree3/: mesh
[system]
unistd.h: base
"""


class CheckLayersTest(unittest.TestCase):
    def check(self, name, line, layers=LAYERS):
        """Returns the script's exit code and complaint about a tree with one file of one line."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for file, text in {"scripts/layers.txt": layers, name: line + "\n"}.items():
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                (root / file).write_text(text)
            done = subprocess.run([sys.executable, SCRIPT, root], capture_output=True, text=True, check=False)
            return done.returncode, done.stderr

    def test_allowed_includes(self):
        for name, line in (
            ("src/mesh/a.cpp", '#include "patchlight/base/b.h"'),
            ("src/mesh/a.cpp", '#include "mesh/b.h"'),
            ("src/mesh/a.cpp", "#include <embree3/rtcore.h>"),
            ("src/mesh/a.cpp", "#include <vector>"),
            ("src/base/a.cpp", "#include <unistd.h>"),
            ("include/patchlight/mesh/a.h", "#include <Eigen/Core>"),
        ):
            with self.subTest(line):
                self.assertEqual(self.check(name, line), (0, ""))

    def test_forbidden_includes(self):
        for name, line, named in (
            ("src/base/a.cpp", '#include "patchlight/mesh/b.h"', "base may not include mesh"),
            ("src/base/a.cpp", '#include "mesh/b.h"', "base may not include mesh"),
            ("include/patchlight/base/a.h", '#include "patchlight/mesh/b.h"', "base may not include mesh"),
            ("src/base/a.cpp", "#include <embree3/rtcore.h>", "base may not include <embree3/rtcore.h>"),
            ("src/mesh/a.cpp", "#include <strange/a.h>", "<strange/a.h> is not in scripts/layers.txt"),
            ("include/patchlight/mesh/a.h", "#include <embree3/rtcore.h>", "a public header may not"),
            ("src/strange/a.cpp", "#include <vector>", "module strange is not in scripts/layers.txt"),
        ):
            with self.subTest(line):
                code, complaint = self.check(name, line)
                self.assertEqual(code, 1)
                self.assertIn(named, complaint)

    def test_cycle(self):
        code, complaint = self.check("src/base/a.cpp", "", LAYERS.replace("base:\nmesh: base", "base: mesh\nmesh: base"))
        self.assertEqual(code, 1)
        self.assertIn("base names mesh", complaint)


if __name__ == "__main__":
    unittest.main()
