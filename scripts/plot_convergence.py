#!/usr/bin/env python3
"""Draws the plots of a comparison of solvers once more, with matplotlib: error by iteration, operator application, second.

usage: scripts/plot_convergence.py FOLDER [-o OUT_FOLDER]

FOLDER holds the history.csv of the comparison, with the columns solver,iteration,applications,seconds,
relative_residual,error_bound,true_error. The plots go to OUT_FOLDER, which is made, or to FOLDER:
error_by_iteration, error_by_application and error_by_second, as .png and .svg. Without matplotlib nothing is drawn.
"""
import argparse
import csv
import math
import pathlib
import sys

# Okabe and Ito, "Color Universal Design" (2008), without the yellow.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]
MARKERS = ["o", "s", "^", "D", "v", "*", "p", "X"]
DASHES = ["-", "--", ":", "-."]
PLOTS = [("error_by_iteration", "iteration", "iterations"), ("error_by_application", "applications", "operator applications"),
         ("error_by_second", "seconds", "seconds")]
COLUMNS = ["iteration", "applications", "seconds", "true_error"]


def number(text):
    """The number in a field; an empty field is not a number."""
    return float(text) if text else math.nan


def read_history(file):
    """The rows of each solver, in the order of the file, each {column: number}."""
    solvers = {}
    with file.open(newline="", encoding="utf-8") as lines:
        for row in csv.DictReader(lines):
            values = {column: number(row[column]) for column in COLUMNS}
            solvers.setdefault(row["solver"], []).append(values)
    return solvers


def draw(pyplot, solvers, column, label):
    figure, axes = pyplot.subplots(figsize=(9, 6), dpi=100, layout="constrained")
    for k, (name, rows) in enumerate(solvers.items()):
        # Values must be positive on a logarithmic axis.
        points = [(row[column], row["true_error"]) for row in rows if 0 < row["true_error"] < math.inf]
        axes.plot([x for x, _ in points], [y for _, y in points], label=name, color=COLOURS[k % len(COLOURS)],
                  linestyle=DASHES[k // len(COLOURS) % len(DASHES)], marker=MARKERS[k % len(MARKERS)], markersize=5,
                  markevery=max(1, len(points) // 12))
    axes.set_yscale("log")
    axes.set_xlim(left=0)
    axes.set_xlabel(label)
    axes.set_ylabel("relative error")
    axes.grid(color="0.85")
    if solvers:
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER")
    parser.add_argument("-o", dest="out", type=pathlib.Path, metavar="OUT_FOLDER")
    arguments = parser.parse_args()
    try:
        import matplotlib
        matplotlib.use("Agg")  # draws without a display
        from matplotlib import pyplot
    except ImportError:
        print("plot_convergence: matplotlib is not installed; nothing is drawn (Debian: python3-matplotlib)")
        return 0
    # The same identifiers in every run.
    matplotlib.rcParams["svg.hashsalt"] = "patchlight"

    file = arguments.folder / "history.csv"
    try:
        solvers = read_history(file)
    except (OSError, ValueError) as error:
        sys.exit(f"error: {file}: {error}")
    except KeyError as error:
        sys.exit(f"error: {file}: has no column {error}")
    out = arguments.out or arguments.folder
    out.mkdir(parents=True, exist_ok=True)
    for name, column, label in PLOTS:
        figure = draw(pyplot, solvers, column, label)
        figure.savefig(out / f"{name}.png")
        figure.savefig(out / f"{name}.svg", metadata={"Date": None})
        pyplot.close(figure)
    print(f"plot_convergence: {len(PLOTS)} plots of {len(solvers)} solvers in {out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
