#!/usr/bin/env python3
"""Prints how far the error bars of rows of rays hold in six scenes, as the table in docs/benchmarks/accuracy.md.

usage: scripts/ray_bars.py BUILD [--patches N] [--checked N] [--paths N]

BUILD holds tests/benchmarks/benchmark_rays, which solves each scene and traces paths to the checked patches. Errors are
relative to the light that is reflected.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

from large_rooms import errors

SCRIPTS = pathlib.Path(__file__).resolve().parent
SCENES = ["two_rooms", "blocks", "contact", "corridor", "door_ajar", "boxes"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--patches", default="16000")
    parser.add_argument("--checked", type=int, default=4000)
    parser.add_argument("--paths", type=int, default=2048, help="of each of them")
    options = parser.parse_args()
    print("| scene | stated error | true error | noise of paths | stated / true | median | within two bars |")
    print("|" + "---|" * 7)
    with tempfile.TemporaryDirectory(prefix="patchlight-bars-") as name:
        folder = pathlib.Path(name)
        for script, more in (("make_varied_rooms.py", []), ("make_large_rooms.py", ["4"])):
            subprocess.run([sys.executable, str(SCRIPTS / script), str(folder), *more], check=True,
                           stdout=subprocess.DEVNULL)
        for scene in SCENES:
            stored = SCRIPTS.parent / "meshes" / f"{scene}.obj"
            model = stored if stored.exists() else folder / f"{scene}.obj"
            e = errors(options.build, model, options.patches, options.checked, options.paths)
            # The noise of the paths, taken out of the error, may leave nothing.
            ratio = f"{e['stated'] / e['error']:.2f}" if e["error"] > 0 else "-"
            print(f"| {scene} | {e['stated']:.4f} | {e['error']:.4f} | {e['noise']:.4f} | {ratio} | {e['median']:.4f} | "
                  f"{e['covered']:.2f} |", flush=True)


if __name__ == "__main__":
    main()
