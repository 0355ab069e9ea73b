#!/usr/bin/env python3
"""Runs the code of notebooks, cell by cell, as a notebook would.

usage: PYTHONPATH=build/python scripts/run_notebooks.py [--store] [NOTEBOOK...]    default: all of docs/tutorials
With --store the printed lines and the figures of each cell are stored in the notebook.
Ends with 77 if numpy or scipy is missing. Without matplotlib, cells that draw, marked "# draws", are skipped.
"""
import base64
import contextlib
import importlib.util
import io
import json
import os
import pathlib
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs/tutorials"


def figures():
    """The open figures of matplotlib as outputs of a cell; closes them."""
    if "matplotlib.pyplot" not in sys.modules:
        return []
    plt = sys.modules["matplotlib.pyplot"]
    found = []
    for number in plt.get_fignums():
        png = io.BytesIO()
        plt.figure(number).savefig(png, format="png", dpi=80, bbox_inches="tight", metadata={"Software": None})
        found.append({"output_type": "display_data", "metadata": {},
                      "data": {"image/png": base64.b64encode(png.getvalue()).decode() + "\n", "text/plain": ["<Figure>"]}})
    plt.close("all")
    return found


def run(file, store):
    """Runs one notebook; an exception of a cell ends the script."""
    names = {"__name__": "__main__"}
    can_draw = importlib.util.find_spec("matplotlib") is not None
    notebook = json.loads(file.read_text(encoding="utf-8"))
    begin, count = time.monotonic(), 0
    for number, cell in enumerate(notebook["cells"]):
        text = "".join(cell["source"])
        if cell["cell_type"] != "code" or (text.startswith("# draws") and not can_draw):
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(text, f"{file.name}, cell {number}", "exec"), names)  # pylint: disable=exec-used
        count += 1
        sys.stdout.write(printed.getvalue())
        cell["execution_count"] = count
        cell["outputs"] = figures()
        if printed.getvalue():
            cell["outputs"].insert(0, {"output_type": "stream", "name": "stdout", "text": printed.getvalue().splitlines(True)})
    print(f"{file.name}: {count} cells in {time.monotonic() - begin:.1f} s", flush=True)
    if store:
        file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def main():
    if any(importlib.util.find_spec(name) is None for name in ("numpy", "scipy")):
        print("skipped: there is no numpy or no scipy")
        sys.exit(77)
    os.environ.setdefault("MPLBACKEND", "Agg")
    store = "--store" in sys.argv[1:]
    files = [pathlib.Path(name).resolve() for name in sys.argv[1:] if name != "--store"] or sorted(FOLDER.glob("*.ipynb"))
    os.chdir(FOLDER)
    for file in files:
        run(file, store)


if __name__ == "__main__":
    main()
