#!/usr/bin/env python3
"""Prints where pairs and rows of rays cross: the error that a solution states and the processor seconds that it takes,
with either storage and more and more patches: docs/benchmarks/speed.md.

usage: scripts/storage_costs.py TOOL [--models M,M...] [--patches N,N...]

The seconds are those of a whole run of all threads, without error bars for pairs (rows of rays have them anyway); the
errors are those of a run with them, relative to the reflected light: of mesh and form factors together.
"""
import argparse
import json
import os
import pathlib
import sys
import tempfile

MESHES = pathlib.Path(__file__).resolve().parent.parent / "meshes"


def solved(tool, model, patches, storage, folder, *options):
    """Processor seconds and the report of a run."""
    report = folder / "report.json"
    words = [tool, "solve", model, "--sides", "front", "--patches", patches, "--method", storage, "-q",
             "-o", folder / "result.vtp", "--json", report, *options]
    words = [str(word) for word in words]
    _, status, used = os.wait4(os.posix_spawnp(words[0], words, os.environ), 0)
    if status != 0:
        sys.exit(f"error: {' '.join(words)} failed")
    return used.ru_utime + used.ru_stime, json.loads(report.read_text())


def row(tool, model, patches, folder):
    by_rays, of_rays = solved(tool, model, patches, "rays", folder)
    by_pairs, _ = solved(tool, model, patches, "pairs", folder)
    with_bars, of_pairs = solved(tool, model, patches, "pairs", folder, "--error-bars")
    pairs, rays = (100 * report["relative_error"]["total"] for report in (of_pairs, of_rays))
    return (f"| {pathlib.Path(model).stem} | {patches} | {by_pairs:.1f} | {with_bars:.1f} | {pairs:.2f} | "
            f"{by_rays:.1f} | {rays:.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--models", type=lambda text: text.split(","),
                        default=[MESHES / "cornell_box.obj", MESHES / "two_rooms.obj"])
    parser.add_argument("--patches", default="1000,2000,4000,8000,16000,32000", type=lambda text: text.split(","))
    options = parser.parse_args()
    print("| model | patches | pairs, CPU s | and error bars, CPU s | error of pairs, % | rays, CPU s | error of rays, % |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="patchlight-storages-") as name:
        for model in options.models:
            for patches in options.patches:
                print(row(options.tool, model, patches, pathlib.Path(name)), flush=True)


if __name__ == "__main__":
    main()
