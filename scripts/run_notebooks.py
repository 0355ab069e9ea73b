#!/usr/bin/env python3
"""Runs the code of notebooks, cell by cell, as a notebook would.

usage: PYTHONPATH=build/python scripts/run_notebooks.py [NOTEBOOK...]    default: all of docs/notebooks
Ends with 77 where numpy or scipy is missing. Without matplotlib cells that draw, marked "# draws", are left out.
"""
import importlib.util
import json
import os
import pathlib
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def run(file):
    """Runs one notebook; whatever its cells raise ends the script."""
    names = {"__name__": "__main__"}
    can_draw = importlib.util.find_spec("matplotlib") is not None
    begin, count = time.monotonic(), 0
    for number, cell in enumerate(json.loads(file.read_text(encoding="utf-8"))["cells"]):
        text = "".join(cell["source"])
        if cell["cell_type"] != "code" or (text.startswith("# draws") and not can_draw):
            continue
        exec(compile(text, f"{file.name}, cell {number}", "exec"), names)  # pylint: disable=exec-used
        count += 1
    print(f"{file.name}: {count} cells in {time.monotonic() - begin:.1f} s", flush=True)


def main():
    if any(importlib.util.find_spec(name) is None for name in ("numpy", "scipy")):
        print("left out: there is no numpy or no scipy")
        sys.exit(77)
    os.environ.setdefault("MPLBACKEND", "Agg")
    files = [pathlib.Path(name).resolve() for name in sys.argv[1:]] or sorted((ROOT / "docs/notebooks").glob("*.ipynb"))
    os.chdir(ROOT / "docs/notebooks")
    for file in files:
        run(file)


if __name__ == "__main__":
    main()
