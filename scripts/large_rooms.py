#!/usr/bin/env python3
"""Prints what rows of rays cost and err in large rooms, as the table in docs/benchmarks/speed.md.

usage: scripts/large_rooms.py BUILD [--room boxes|uplight|spheres] [--patches N,N...] [--checked N] [--paths N] [--rays N]

BUILD holds src/patchlight and tests/benchmarks/benchmark_rays. The cost is that of `patchlight solve --rays N`, the
result written: processor seconds of all threads, stage by stage, and the largest memory. The error is relative to the
light that is reflected, against path tracing of some patches, by benchmark_rays; the noise of the paths is taken out of
it, but not out of the median.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

STAGES = ["read", "plan", "mesh", "form factors", "solve", "error bars", "write"]


def measured(words):
    """Processor seconds and the largest memory in GB."""
    _, status, used = os.wait4(os.posix_spawnp(words[0], words, os.environ), 0)
    if status != 0:
        sys.exit(f"error: {' '.join(words)} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss * 1024 / 1e9


def solved(build, model, patches, rays, folder):
    report = folder / "report.json"
    words = [build / "src/patchlight", "solve", model, "--rays", rays, "--patches", patches, "-q", "-o",
             folder / "result.vtp", "--json", report]
    seconds, gigabytes = measured([str(word) for word in words])
    told = json.loads(report.read_text())
    costs = {cost["stage"]: cost["cpu_seconds"] for cost in told["costs"]}
    return seconds, gigabytes, costs


def errors(build, model, patches, checked, paths, rays=64):
    words = [build / "tests/benchmarks/benchmark_rays", model, patches, checked, paths, rays]
    text = subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout
    names = {"error": r"error ([\d.]+)", "noise": r"noise of paths ([\d.]+)", "stated": r"stated ([\d.]+)",
             "median": r"median ([\d.]+)", "all": r"bar of all patches ([\d.]+)", "covered": r"within two bars ([\d.]+)"}
    return {name: float(re.search(pattern, text).group(1)) for name, pattern in names.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--room", default="boxes", choices=["boxes", "uplight", "spheres"])
    parser.add_argument("--patches", default="32000,100000,300000,1000000", type=lambda text: text.split(","))
    parser.add_argument("--checked", type=int, default=400, help="patches, 0: no errors")
    parser.add_argument("--paths", type=int, default=32768, help="of each of them")
    parser.add_argument("--rays", type=int, default=64, help="of a patch")
    options = parser.parse_args()
    print("| patches | CPU s | GB | " + " | ".join(STAGES) +
          " | bar | stated / true error | noise of paths | median | within two bars |")
    print("|" + "---|" * (8 + len(STAGES)))
    with tempfile.TemporaryDirectory(prefix="patchlight-rooms-") as name:
        folder = pathlib.Path(name)
        script = pathlib.Path(__file__).resolve().parent / "make_large_rooms.py"
        subprocess.run([sys.executable, str(script), str(folder)], check=True)
        model = folder / f"{options.room}.obj"
        for patches in options.patches:
            seconds, gigabytes, costs = solved(options.build, model, patches, options.rays, folder)
            parts = " | ".join(f"{costs.get(stage, 0):.1f}" for stage in STAGES)
            row = f"| {patches} | {seconds:.1f} | {gigabytes:.2f} | {parts} |"
            if options.checked > 0:
                e = errors(options.build, model, patches, options.checked, options.paths, options.rays)
                row += (f" {e['all']:.4f} | {e['stated']:.4f} / {e['error']:.4f} | {e['noise']:.4f} | {e['median']:.4f} | "
                        f"{e['covered']:.2f} |")
            print(row, flush=True)


if __name__ == "__main__":
    main()
