"""Compares what ParaView makes of a result and of a series with the report. Run by scripts/check_paraview.sh:

    pvbatch scripts/check_paraview.py FOLDER NAME

FOLDER holds NAME.vtp, .ply, .glb, .pvd and .json of one run; the screenshots are written there.
"""
import json
import math
import os
import pathlib
import runpy
import sys

from paraview import servermanager, simple
from vtkmodules.vtkIOImage import vtkPNGReader

MACRO = pathlib.Path(__file__).resolve().parent / "paraview_view.py"
FLOAT = 2.0**-23  # the arrays are floats: one rounding, half of this, and one more in ParaView's sums

faults = []


def check(true, what):
    print(("ok     " if true else "FAULT  ") + what, flush=True)
    if not true:
        faults.append(what)


def near(a, b, relative):
    return math.isclose(a, b, rel_tol=relative, abs_tol=1e-30)


def reader_of(name, file):
    reader = name(FileName=[str(file)]) if name is simple.XMLPolyDataReader else name(FileName=str(file))
    reader.UpdatePipeline()
    return reader


def check_ranges(result, report):
    """The largest and smallest irradiance of all materials are the array's range."""
    materials = [material for material in report["materials"] if material["area_m2"] > 0]
    ranges = result.CellData["irradiance"]
    for band in range(3):
        low = min(material["irradiance_min_W_m2"][band] for material in materials)
        high = max(material["irradiance_max_W_m2"][band] for material in materials)
        found = ranges.GetRange(band)
        check(near(found[0], low, FLOAT) and near(found[1], high, FLOAT),
              f"irradiance of band {band}: ParaView finds {found}, the report says {low} to {high}")


def check_units(result, report):
    """ParaView shows the units, and they are those of the report's keys."""
    facts = servermanager.Fetch(result).GetFieldData()

    def text(name):
        array = facts.GetAbstractArray(name)
        return array.GetValue(0) if array else None

    expected = {"radiance": "W/(m^2 sr)", "radiosity": "W/m^2", "irradiance": "W/m^2", "direct_irradiance": "W/m^2",
                "indirect_irradiance": "W/m^2", "exitance": "W/m^2", "luminance": "cd/m^2", "area": "m^2"}
    for name, unit in expected.items():
        check(result.CellData.GetArray(name) is not None and text("unit_" + name) == unit, f"{name} is in {unit}")
    check("irradiance_max_W_m2" in report["materials"][0], "the report has irradiances in W/m^2, too")
    check(text("sha256") == report["input"]["sha256"], "the hash of the input is the report's")
    check(facts.GetArray("exposure").GetValue(0) == report["exposure"], "the exposure is the report's")


def check_flux(result, report):
    """ParaView's integral of the exitance is the flux emitted, that of direct and indirect light adds up."""
    total = servermanager.Fetch(simple.IntegrateVariables(Input=result)).GetCellData()

    def integral(name):
        return total.GetArray(name).GetTuple(0)

    for band in range(3):
        emitted = report["energy_balance"]["emitted_W"][band]
        found = integral("exitance")[band]
        check(near(found, emitted, 4 * FLOAT), f"emitted flux of band {band}: integral {found}, report {emitted}")
        parts = integral("direct_irradiance")[band] + integral("indirect_irradiance")[band]
        check(near(parts, integral("irradiance")[band], 4 * FLOAT), f"direct and indirect light of band {band} add up")


def colours_of(data):
    rgb = data.GetCellData().GetArray("rgb")
    return {tuple(int(c) for c in rgb.GetTuple(k)) for k in range(rgb.GetNumberOfTuples())}


def pixels_of(file):
    reader = vtkPNGReader()
    reader.SetFileName(str(file))
    reader.Update()
    return reader.GetOutput().GetPointData().GetScalars()


def check_screenshot(file, data):
    """Colors come out as they stand in the array, neither mapped nor shaded; only edges are mixed."""
    pixels = pixels_of(file)
    known, shown, lit = colours_of(data), 0, 0
    for k in range(pixels.GetNumberOfTuples()):
        pixel = pixels.GetTuple(k)
        if sum(pixel) > 0:
            lit += 1
            shown += tuple(int(c) for c in pixel[:3]) in known
    check(lit > 0.1 * pixels.GetNumberOfTuples(), f"{file.name}: {lit} pixels show the model")
    check(shown > 0.9 * lit, f"{file.name}: {100 * shown / max(lit, 1):.1f} % of them have a colour of the array rgb")


def mean_colour(file):
    """Over the pixels that show the model."""
    pixels = pixels_of(file)
    lit = [pixels.GetTuple(k)[:3] for k in range(pixels.GetNumberOfTuples()) if sum(pixels.GetTuple(k)) > 0]
    return [sum(pixel[channel] for pixel in lit) / max(len(lit), 1) for channel in range(3)]


def check_smooth(result, file):
    """The macro shows the colors of the points of a result: the same light as that of the patches, smoothed."""
    view = simple.CreateView("RenderView")
    simple.SetActiveView(view)
    simple.SetActiveSource(result)
    runpy.run_path(str(MACRO))
    simple.GetActiveCamera().Zoom(1.2)
    simple.SaveScreenshot(str(file), view, ImageResolution=[1000, 1000])
    smooth, patches = mean_colour(file), mean_colour(file.with_name(file.stem + "_patches.png"))
    check(all(abs(a - b) <= 3 for a, b in zip(smooth, patches)), f"smooth colours {smooth} are those of patches {patches}")
    simple.Delete(view)


def screenshot(source, file, time=0.0):
    """The colors of patches: a source is active, the macro runs; then the time slider is moved."""
    view = simple.CreateView("RenderView")
    simple.SetActiveView(view)
    simple.SetActiveSource(source)
    runpy.run_path(str(MACRO))["show_colours"](source, view, of_patches=True)
    simple.GetAnimationScene().AnimationTime = time
    simple.GetActiveCamera().Zoom(1.2)
    simple.SaveScreenshot(str(file), view, ImageResolution=[1000, 1000])
    source.UpdatePipeline(time)
    check_screenshot(file, servermanager.Fetch(source))
    simple.Delete(view)


def check_series(folder, name, result, report):
    series = reader_of(simple.PVDReader, folder / (name + ".pvd"))
    iterations = report["solution"]["iterations"]
    check(list(series.TimestepValues) == [row["number"] for row in iterations],
          f"the series has the times 0 to {len(iterations) - 1}")
    highest = []
    for time in series.TimestepValues:
        series.UpdatePipeline(time)
        highest.append(series.CellData["irradiance"].GetRange(0)[1])
    check(highest[0] == 0, "at time 0 no light has arrived")
    check(all(later >= earlier for earlier, later in zip(highest, highest[1:])), "it grows from bounce to bounce")
    final = result.CellData["irradiance"].GetRange(0)[1]
    # The stopping rule bounds the error in the norm; a single patch of n may hold all of it.
    tolerance = report["request"]["tolerance"] * math.sqrt(report["mesh"]["patches"])
    check(near(highest[-1], final, tolerance), f"and ends at the result's {final}")
    direct = result.CellData["direct_irradiance"].GetRange(0)[1]
    check(near(highest[1], direct, FLOAT), f"time 1 is the direct light, at most {direct}")
    screenshot(series, folder / (name + "_direct.png"), time=1.0)
    screenshot(series, folder / (name + "_bounce_5.png"), time=5.0)


def check_coloured(folder, name, report):
    ply = reader_of(lambda FileName: simple.PLYReader(FileNames=[FileName]), folder / (name + ".ply"))
    check(ply.GetDataInformation().GetNumberOfCells() == report["mesh"]["patches"], "the .ply has all patches")
    glb = simple.OpenDataFile(str(folder / (name + ".glb")))
    glb.UpdatePipeline()
    check(glb.GetDataInformation().GetNumberOfPoints() == report["mesh"]["vertices"], "the .glb has all vertices")


def main():
    folder, name = pathlib.Path(sys.argv[1]), sys.argv[2]
    report = json.loads((folder / (name + ".json")).read_text())
    result = reader_of(simple.XMLPolyDataReader, folder / (name + ".vtp"))
    check(result.GetDataInformation().GetNumberOfCells() == report["mesh"]["patches"], "one cell per patch")
    check_ranges(result, report)
    check_units(result, report)
    check_flux(result, report)
    screenshot(result, folder / (name + "_patches.png"))
    check_smooth(result, folder / (name + ".png"))
    check_series(folder, name, result, report)
    check_coloured(folder, name, report)
    print(f"paraview: {len(faults)} faults; screenshots in {folder}", flush=True)
    sys.stdout.flush()
    os._exit(1 if faults else 0)  # pvbatch itself ends with 0


main()
