#!/usr/bin/env python3
"""Prints how the error of patch means falls in a closed cube, with even patches and with graded edges.

usage: graded_edges.py TOOL [FINEST]

A unit cube of reflectance .5 whose floor emits. FINEST, 64 by default, is the number of patches along an edge of the
reference, a power of two; meshes of each kind have their own, whose points their points are among. Needs python3-numpy.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

CUBE = """mtllib cube.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
v 1 0 1
v 1 1 1
v 0 1 1
usemtl lamp
f 1 2 3 4
usemtl wall
f 5 8 7 6
f 1 4 8 5
f 2 6 7 3
f 1 5 6 2
f 4 3 7 8
"""
MATERIALS = "newmtl lamp\nKd .5 .5 .5\nKe 1 1 1\nnewmtl wall\nKd .5 .5 .5\n"


def means(tool, folder, parts, words):
    """Irradiances and areas per wall, row and column."""
    command = [tool, "form-factors", "cube.obj", "-o", "cube.ff", "--max-edge", str(1 / parts), "--sides", "front", *words]
    subprocess.run(command, cwd=folder, check=True, capture_output=True)
    factors = np.load(folder / "cube.ff/F.npy")
    area = np.load(folder / "cube.ff/area.npy")
    emitted = np.repeat([1, 0, 0, 0, 0, 0], parts * parts).astype(float)
    radiosity = emitted.copy()
    for _ in range(60):  # .5^60 < 1e-18
        radiosity = emitted + 0.5 * (factors @ radiosity)
    return radiosity.reshape(6, parts, parts), area.reshape(6, parts, parts)


def error(coarse, fine):
    """Of the coarse means in the area norm, as a share of the light that is reflected."""
    (values, _), (reference, area) = coarse, fine
    n, k = values.shape[1], reference.shape[1] // values.shape[1]
    blocks = (6, n, k, n, k)
    areas = area.reshape(blocks).sum((2, 4))
    exact = (reference * area).reshape(blocks).sum((2, 4)) / areas
    reflected = exact - np.array([1, 0, 0, 0, 0, 0]).reshape(6, 1, 1)
    return np.sqrt((areas * (values - exact) ** 2).sum() / (areas * reflected**2).sum())


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    tool = str(Path(sys.argv[1]).resolve())
    finest = int(sys.argv[2]) if len(sys.argv) == 3 else 64
    sizes = [n for n in (4, 8, 16, 32) if n < finest]
    errors = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "cube.obj").write_text(CUBE)
        (folder / "cube.mtl").write_text(MATERIALS)
        for words in ([], ["--graded-edges"]):
            reference = means(tool, folder, finest, words)
            errors.append([error(means(tool, folder, n, words), reference) for n in sizes])
    for k, n in enumerate(sizes):
        cells = [str(n)]
        for found in errors:
            order = f"{np.log2(found[k - 1] / found[k]):.2f}" if k > 0 else ""
            cells += [f"{100 * found[k]:.3f}", order]
        print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
