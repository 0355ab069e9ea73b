#!/usr/bin/env python3
"""What pictures of two rooms err by, against the processor seconds that they take: a table for docs/benchmarks/pictures.md.

usage: scripts/picture_curve.py TOOL FOLDER [--patches N]

Solves meshes/two_rooms.obj and meshes/cornell_box.obj, and takes pictures of 256 x 256 pixels: drafts and final ones
for several wanted errors. The reference is a final picture with 512 samples a pixel of a solution with ten times the
patches. Errors count as in scripts/compare_pictures.py; CPU seconds are those of `render`, the reading of the solution
with it.
"""
import argparse
import math
import pathlib
import resource
import subprocess

from compare_pictures import layers, quantile

MESHES = pathlib.Path(__file__).resolve().parent.parent / "meshes"
# With cameras: the default one follows from the solution.
ROOMS = {"two_rooms": ("0.32,2.41,1.23", "1.29,2.218,1.082", "72"),
         "cornell_box": ("0.2764,0.2744,-0.7488", "0.2764,0.2744,0", "42")}
SIZE = ["--size", "256x256"]
ERRORS = ("10%", "5%", "2%", "1%", "0.5%")
SETTINGS = [("draft", ["--picture-quality", "draft"])] + [
    (f"final, {error}", ["--picture-quality", "final", "--picture-error", error]) for error in ERRORS]


def cpu_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def solved(tool, folder, room, patches):
    file = folder / f"{room}_{patches}.vtp"
    subprocess.run([tool, "solve", MESHES / f"{room}.obj", "--patches", str(patches), "-o", file, "-q"], check=True)
    return file


def picture(tool, room, solution, file, words):
    model = MESHES / f"{room}.obj"
    return cpu_seconds([tool, "render", model, "--solution", solution, "-o", file, "-q", *SIZE, "--camera", *ROOMS[room],
                        *words])


def relative_differences(file, reference):
    """Of pixels that show a patch in the reference; a draft has no layers but the colors."""
    least = quantile([v for v in reference["luminance.Y"] if v > 0], .9) / 20
    found = layers(file)["luminance.Y"]
    return [(found[k] - v) / max(v, least) for k, v in enumerate(reference["luminance.Y"])
            if reference["patch.id"][k] != 0xffffffff]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--patches", type=int, default=2000)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    print("| room | picture | CPU s | rms | median |\n|---|---|---|---|---|")
    meshes = []
    for room in ROOMS:
        fine = solved(given.tool, given.folder, room, 10 * given.patches)
        coarse = solved(given.tool, given.folder, room, given.patches)
        file = given.folder / f"{room}_reference.exr"
        picture(given.tool, room, fine, file, ["--picture-error", "0.1%", "--picture-samples", "512"])
        reference = layers(file)
        for name, words in SETTINGS:
            file = given.folder / f"{room}_{name.replace(', ', '_').replace('%', '')}.exr"
            seconds = picture(given.tool, room, coarse, file, words)
            off = relative_differences(file, reference)
            rms = math.sqrt(sum(v * v for v in off) / len(off))
            median = quantile([abs(v) for v in off], .5)
            print(f"| {room} | {name} | {seconds:.1f} | {100 * rms:.2f} % | {100 * median:.2f} % |", flush=True)
        # The same picture of either solution: what the mesh shows through the gather
        of_fine = given.folder / f"{room}_of_fine.exr"
        picture(given.tool, room, fine, of_fine, SETTINGS[-1][1])
        off = relative_differences(file, layers(of_fine))
        rms = math.sqrt(sum(v * v for v in off) / len(off))
        meshes.append(f"{room}: final pictures at {ERRORS[-1]} of {given.patches} and {10 * given.patches} patches "
                      f"differ by {100 * rms:.2f} % rms")
    print("\n".join([""] + meshes))


if __name__ == "__main__":
    main()
