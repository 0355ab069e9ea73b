#!/usr/bin/env python3
"""Prints how far the level of the light scatters that rows of rays find in a bright room: docs/theory/ray-method-solution.md.

usage: scripts/ray_levels.py TOOL MODEL [--reflectance R,R...] [--patches N,N...] [--seeds N]

The level is the flux that all materials reflect, in the first band. It is compared with that of a solution by pairs with
four times the patches. `blocks.obj` of scripts/make_varied_rooms.py is the model of the page.
"""
import argparse
import json
import math
import pathlib
import subprocess
import tempfile


def level(tool, model, reflectance, patches, folder, *options):
    report = folder / "report.json"
    words = [tool, "solve", model, "--sides", "front", "--set", f"*.reflectance={reflectance}", "--patches", patches, "-q",
             "-o", folder / "result.ply", "--json", report, *options]
    subprocess.run([str(word) for word in words], check=True)
    told = json.loads(report.read_text())
    return sum(part["reflectance"][0] * part["irradiance_mean_W_m2"][0] * part["area_m2"] for part in told["materials"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("--reflectance", default="0.9,0.99", type=lambda text: text.split(","))
    parser.add_argument("--patches", default="500,2000", type=lambda text: [int(part) for part in text.split(",")])
    parser.add_argument("--seeds", type=int, default=8)
    options = parser.parse_args()
    print("| reflectance | patches | root mean square, % | largest, % |\n|---|---|---|---|")
    with tempfile.TemporaryDirectory(prefix="patchlight-levels-") as name:
        for reflectance in options.reflectance:
            for patches in options.patches:
                def solved(count, *more):
                    return level(options.tool, options.model, reflectance, count, pathlib.Path(name), *more)
                reference = solved(4 * patches, "--method", "pairs")
                off = [100 * (solved(patches, "--method", "rays", "--seed", seed) / reference - 1)
                       for seed in range(1, options.seeds + 1)]
                rms = math.sqrt(sum(value * value for value in off) / len(off))
                print(f"| {reflectance} | {patches} | {rms:.3f} | {max(map(abs, off)):.3f} |", flush=True)


if __name__ == "__main__":
    main()
