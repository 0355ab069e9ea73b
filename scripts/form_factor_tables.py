#!/usr/bin/env python3
"""Prints what scripts/form_factor_costs.sh has measured as Markdown tables. usage: form_factor_tables.py OUT"""

import json
import math
import pathlib
import re
import statistics
import sys

ROW_SUM_GOAL = 3e-4
LARGE, SMALL = "large_closed_room_40_0", "curve_closed_room_10_0"
ERRORS = ["errors_closed_room_10_0", "errors_closed_room_20_0", "errors_two_rooms_2000"]
BINS = 8


class Measured:
    """The counters of one JSON file: medians over repetitions, by the benchmark's name and arguments."""

    def __init__(self, folder, name):
        path = folder / f"{name}.json"
        runs = json.loads(path.read_text())["benchmarks"] if path.exists() else []
        values = {}
        for run in runs:
            if run.get("run_type") == "iteration":
                values.setdefault(run["name"].split("/iterations")[0], []).append(run)
        self.runs = {key: medians(of_key) for key, of_key in values.items()}

    def of(self, name):
        """(samples, counters) of the runs whose names match."""
        found = []
        for key, counters in self.runs.items():
            if re.match(name, key):
                numbers = [int(n) for n in re.findall(r":(\d+)", key)]
                found.append((numbers[0] if numbers else 0, counters))
        return sorted(found, key=lambda run: run[0])

    def patches(self):
        return next(iter(self.runs.values()))["patches"]


def medians(runs):
    names = [n for n, value in runs[0].items() if isinstance(value, (int, float))]
    return {n: statistics.median(run[n] for run in runs) for n in names}


def table(head, rows):
    print("\n| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def short(x, digits=2):
    """Two significant digits: 0.17, 12, 2.7e-4."""
    if x == 0:
        return "0"
    if abs(x) < 1e-2:
        mantissa, exponent = f"{x:.{digits - 1}e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{x:.{max(0, digits - 1 - math.floor(math.log10(abs(x))))}f}"


def percent(x):
    return f"{100 * x:.1f} %"


def count(x):
    return f"{round(x):,}"


def curves(folder, title, names):
    """Rows are settings, column groups rooms."""
    rooms = [m for m in (Measured(folder, name) for name in names) if m.runs]
    if not rooms:
        return
    print(f"### {title}")
    head, cells = ["samples"], {}
    for room in rooms:
        head += [f"{count(room.patches())} patches: rays, M", "CPU s", "row sums"]
        for samples, c in room.of("assemble.*threads:1"):
            row = cells.setdefault(samples, {})
            row[id(room)] = [short(c["rays"] / 1e6, 3), short(c["cpu_s"]), short(c["row_sum_rms"])]
    rows = []
    for setting, row in sorted(cells.items()):
        rows.append([str(setting)] + [x for room in rooms for x in row.get(id(room), ["", "", ""])])
    table(head, rows)


def entries(folder, names):
    print("### Entries against the reference")
    print("\nL1 = sum |S - S_ref| / sum S_ref; p99.9 of |F_ij - F_ref,ij|, absolute, over the ordered pairs whose")
    print("reference is positive; matvec = area-weighted relative L2 error of F x for a smooth field x.")
    rows = []
    for name in names:
        measured = Measured(folder, name)
        for samples, c in measured.of("entries"):
            rows.append(
                [count(measured.patches()), str(samples)]
                + [short(c[k]) for k in ("cpu_s", "row_sum_rms", "l1", "p999", "mean_F", "matvec")]
            )
    table(["patches", "samples", "CPU s", "row sums", "L1", "p99.9", "mean F", "matvec"], rows)


def cheapest(measured, goal=ROW_SUM_GOAL):
    runs = [run for run in measured.of("assemble.*threads:1") if run[1]["row_sum_rms"] <= goal]
    return min(runs, key=lambda run: run[1]["cpu_s"]) if runs else None


def growth(folder):
    print(f"### Growth, with the cheapest setting whose row sums are within {short(ROW_SUM_GOAL)}")
    rows, points = [], []
    for name in (SMALL, "curve_closed_room_20_0", LARGE):
        best = cheapest(Measured(folder, name))
        if best:
            samples, c = best
            points.append((c["patches"], c["cpu_s"]))
            rows.append([count(c["patches"]), str(samples), short(c["cpu_s"]), short(c["row_sum_rms"])])
    table(["patches", "samples", "CPU s", "row sums"], rows)
    if len(points) > 1:
        print(f"Exponent from the first to the last: {exponent(points[0], points[-1]):.2f}.")
    large = Measured(folder, LARGE)
    for samples, c in Measured(folder, SMALL).of("assemble.*threads:1"):
        for s, d in large.of("assemble.*threads:1"):
            if s == samples:
                small, big = (c["patches"], c["cpu_s"]), (d["patches"], d["cpu_s"])
                print(f"With {s} at both ends: {exponent(small, big):.2f}.")
    print("\nThe largest room on two threads:")
    rows = [
        [str(s)] + [short(c[k]) for k in ("wall_s", "cpu_s", "row_sum_rms")] + [short(c["peak_bytes"] / 1e9, 3)]
        for s, c in large.of("assemble.*threads:2")
    ]
    table(["samples", "wall s", "CPU s", "row sums", "peak memory, GB"], rows)


def exponent(first, last):
    return math.log(last[1] / first[1]) / math.log(last[0] / first[0])


def threads(folder, name):
    print("### A second thread")
    print("\nMedians of three interleaved pairs of runs; busy = processors that two threads got of the machine.")
    rows = [
        [str(s), short(c["wall_1"], 3), short(c["wall_2"], 3), f"{c['gain']:.2f}", f"{c['processors_2']:.2f}"]
        for s, c in Measured(folder, name).of("second_thread")
    ]
    table(["samples", "wall s, one", "wall s, two", "gain", "busy"], rows)


def rays(folder, names):
    print("### Shadow rays")
    print("\nEnd to end: all rays of the assembly over all its CPU seconds. Bare: at most 200,000 packets of such")
    print("rays, as if every pair took the usual number,")
    print("from all over the room, through the occluder alone. One thread, in turn, medians of three.")
    rows = []
    for name in names:
        measured = Measured(folder, name)
        for s, c in measured.of("shadow_rays"):
            speeds = [short(c[k] / 1e6, 3) for k in ("rays_per_s", "bare_rays_per_s")]
            rows.append([count(measured.patches()), str(s), *speeds, percent(c["share"])])
    table(["patches", "samples", "end to end, M/s", "bare, M/s", "share"], rows)


def calibration(folder, names):
    print("### Stated errors, defaults, all pairs against the reference")
    rows, bins = [], []
    for name in names:
        measured = Measured(folder, name)
        for _, c in measured.of("calibration"):
            patches = count(measured.patches())
            for kind in ("partial", *(f"bin{b}" for b in range(BINS))):
                label = "all" if kind == "partial" else f"{int(kind[3:]) / BINS:.3f} on"
                z = [f"{c[kind + '_rms_z']:.2f}", f"{c[kind + '_mean_z']:+.2f}"]
                bins.append([patches, label, count(c[kind + "_pairs"]), percent(c[kind + "_within"]), *z])
            for kind in ("visible", "occluded"):
                shares = [percent(c[f"{kind}_{k}"]) for k in ("bound", "within", "audited_rate", "rate")]
                rows.append([patches, f"unanimous, {kind}", count(c[kind + "_pairs"]), *shares])
            for kind, error in (("free", c["free_error"]), ("hidden", 0)):
                wrong = count(c[kind + "_wrong"])
                rows.append([patches, kind, count(c[kind + "_pairs"]), short(error), "", "", wrong])
    print("\nPartly visible pairs by their visible share; z = error / standard error.")
    table(["patches", "visible share", "pairs", "within 1.96", "rms z", "mean z"], bins)
    print("Other pairs. Of free pairs the largest relative error, and how many have a blocked ray among 256; of hidden")
    print("ones how many have a free one.")
    table(["patches", "pairs", "number", "bound", "within it", "missed, audit", "missed, reference"], rows)


def unoccluded(folder, names):
    print("### Unoccluded entries against the contour integral over quarters")
    rows, notes = [], []
    for name in names:
        measured = Measured(folder, name)
        for _, c in measured.of("unoccluded"):
            for zone in ("near", "middle", "far"):
                sizes = [short(c[f"{zone}_{k}"]) for k in ("median", "p999", "max", "max_F")]
                shares = [percent(c[f"{zone}_{k}"]) for k in ("within", "within_F")]
                rows.append([count(measured.patches()), zone, *sizes, *shares])
            above = count(c["entries_above"])
            notes.append(f"{count(measured.patches())} patches: {above} obstructed entries above the unobstructed one.")
            edges = ", ".join(f"{angle} degrees {short(c[f'edge_sharing_{angle}'])}" for angle in (90, 20, 1))
    relative = ["relative: median", "p99.9", "largest", "largest in F"]
    table(["patches", "zone", *relative, "relative < 1e-6", "in F < 1e-6"], rows)
    print("\n".join(notes))
    if notes:
        print(f"Unit squares that share an edge, error of F: {edges}.")


def solutions(folder, names):
    print("\n### Solutions after closure, against that of the reference")
    rows = []
    for name in names:
        measured = Measured(folder, name)
        for s, c in measured.of("solutions"):
            rows.append([count(measured.patches()), str(s), short(c["mixed"]), short(c["bright"])])
    table(["patches", "samples", "rho 0.3 and 0.8", "rho 0.99"], rows)


def goals(folder):
    """Whether what form factors should cost and be worth is reached: the figure, and its limit."""
    rows = []

    def goal(what, found, limit, at_least=False):
        met = found is not None and (found >= limit if at_least else found <= limit)
        figures = ["-" if found is None else short(found, 3), short(limit, 3)]
        rows.append([what, *figures, "met" if met else "not met"])

    for name, limits in ((SMALL, {1e-3: 0.25, 3e-4: 0.55}), ("curve_closed_room_20_0", {1e-3: 1.2, 3e-4: 3, 1.2e-4: 5})):
        measured = Measured(folder, name)
        for row_sums, limit in limits.items():
            best = cheapest(measured, row_sums)
            found = best[1]["cpu_s"] if best else None
            goal(f"{count(measured.patches())} patches, CPU s to row sums within {short(row_sums)}", found, limit)
    within = [run for run in Measured(folder, "errors_closed_room_10_0").of("entries") if run[1]["cpu_s"] <= 0.55]
    for name, limit in (("l1", 2e-3), ("p999", 1.5e-4), ("matvec", 1e-3)):
        found = min((run[1][name] for run in within), default=None)
        goal(f"1,416 patches, {name} of the entries in 0.55 CPU s", found, limit)
    small, large = cheapest(Measured(folder, SMALL)), cheapest(Measured(folder, LARGE))
    if small and large:
        ends = [(c["patches"], c["cpu_s"]) for _, c in (small, large)]
        goal("exponent of the growth", exponent(*ends), 2.1)
    both = [c for _, c in Measured(folder, LARGE).of("assemble.*threads:2") if c["row_sum_rms"] <= ROW_SUM_GOAL]
    goal("22,656 patches, wall s on two threads", min((c["wall_s"] for c in both), default=None), 30)
    goal("22,656 patches, peak memory in GB", min((c["peak_bytes"] / 1e9 for c in both), default=None), 1.3)
    for s, c in Measured(folder, "rays_closed_room_20_0").of("shadow_rays"):
        goal(f"rays end to end / bare, {s} samples", c["share"], 0.5, at_least=True)
    for s, c in Measured(folder, "threads_closed_room_20_0").of("second_thread"):
        goal(f"gain of the second thread, {s} samples", c["gain"], 1.8, at_least=True)
    for name in ERRORS:
        measured = Measured(folder, name)
        for _, c in measured.of("calibration"):
            label = f"{count(measured.patches())} patches"
            goal(f"{label}, groups of partial pairs out of calibration", wrong_groups(c), 0)
            least = min(c["visible_within"], c["occluded_within"])
            goal(f"{label}, unanimous pairs within their bound", least, 0.95, at_least=True)
        for s, c in measured.of("solutions"):
            goal(f"{count(measured.patches())} patches, {s} samples, solution", max(c["mixed"], c["bright"]), 1e-3)
    table(["", "found", "limit", ""], rows)


def wrong_groups(c):
    """Of all partial pairs and the bins with at least 300: not 90 to 99 % within, or an rms z not near 1."""
    groups = [g for g in ("partial", *(f"bin{b}" for b in range(BINS))) if c[g + "_pairs"] >= 300]
    return sum(not (0.9 <= c[g + "_within"] <= 0.99 and 0.8 <= c[g + "_rms_z"] <= 1.25) for g in groups)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    curves(folder, "Two blocks", [SMALL, "curve_closed_room_20_0", LARGE])
    curves(folder, "Two rooms with furniture", ["curve_two_rooms_2000", "curve_two_rooms_8000"])
    curves(folder, "500 boxes", ["curve_boxes_500_5000"])
    growth(folder)
    threads(folder, "threads_closed_room_20_0")
    rays(folder, ["rays_closed_room_20_0", "rays_two_rooms_2000"])
    entries(folder, ERRORS)
    calibration(folder, ERRORS)
    unoccluded(folder, ERRORS)
    solutions(folder, ERRORS)
    print("### Goals")
    goals(folder)


if __name__ == "__main__":
    main()
