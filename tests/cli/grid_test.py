"""Unstructured grids, -o FILE.vtu, read by meshio. Skipped without Debian's package python3-meshio."""
import json
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree

from support import ToolTest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from read_vtp import read_vtp  # noqa: E402

# The system's Python, which uses Debian's packages.
PYTHON = "/usr/bin/python3"
READ = """
import json, sys, meshio
grid = meshio.read(sys.argv[1])
print(json.dumps({"points": grid.points.tolist(), "cells": [[block.type, block.data.tolist()] for block in grid.cells],
                  "cell_data": {name: [part.tolist() for part in parts] for name, parts in grid.cell_data.items()},
                  "point_data": sorted(grid.point_data), "exposure": grid.field_data["exposure"].tolist()}))
"""


def has_meshio():
    return subprocess.run([PYTHON, "-c", "import meshio"], capture_output=True, check=False).returncode == 0


class GridTest(ToolTest):
    @unittest.skipUnless(has_meshio(), "there is no python3-meshio")
    def test_meshio_reads_the_patches_of_the_vtp(self):
        # Patches at a triangle's edges are triangles, the others quadrilaterals.
        self.write("room.obj", (self.folder / "room.obj").read_text() + "usemtl white\nv 0.3 0.3 0.5\nv 0.7 0.3 0.5\nv 0.5 0.7 0.6\nf -3 -2 -1\n")
        done = self.run_tool("solve", "room.obj", "--patches", 100, "-o", "room.vtp", "-o", "room.vtu")
        self.assertEqual(done.returncode, 0, done.stderr)
        ElementTree.parse(self.folder / "room.vtu")
        read = subprocess.run([PYTHON, "-c", READ, self.folder / "room.vtu"], capture_output=True, text=True, check=False)
        self.assertEqual(read.returncode, 0, read.stderr)
        grid = json.loads(read.stdout)
        points, corners, cells = read_vtp(self.folder / "room.vtp")
        self.assertEqual([tuple(point) for point in grid["points"]], [tuple(point) for point in points])
        self.assertEqual({kind for kind, _ in grid["cells"]}, {"triangle", "quad"})
        patches = [tuple(cell) for _, block in grid["cells"] for cell in block]
        self.assertEqual(sorted(patches), sorted(tuple(cell) for cell in corners))
        place = {tuple(cell): k for k, cell in enumerate(corners)}
        self.assertEqual(set(grid["cell_data"]), set(cells))
        for name, parts in grid["cell_data"].items():
            values = [value for part in parts for value in part]
            for patch, value in zip(patches, values):
                expected = list(cells[name][place[patch]])
                self.assertEqual(value if isinstance(value, list) else [value], expected, name)
        self.assertIn("radiance_smooth", grid["point_data"])

    def test_render_names_the_file_that_it_takes(self):
        done = self.run_tool("render", "room.obj", "--solution", "room.vtu", "-o", "view.png")
        self.assertEqual(done.returncode, 1)
        for name in ("--solution", "room.vtu", ".vtp"):
            self.assertIn(name, done.stderr)


if __name__ == "__main__":
    unittest.main()
