#!/usr/bin/env pvpython
"""Shows a result of patchlight in ParaView as it looks to the eye.

From the command line, with or without a picture:

    pvpython scripts/paraview_view.py [--patches] result.vtp [screenshot.png]

In ParaView's window: Macros > Import new macro, choose this file, open a result, press the macro's button.

It shows the colors `rgb_smooth` of the points of a result. With --patches before the file, or for a series, it shows
`rgb`, one color per patch. These colors are final: no color map (Map Scalars off) and no shading (lighting off) apply.
Back faces are culled, so that you look into a room through its walls.
"""
import sys

from paraview import simple


def set_where_known(proxy, **values):
    """Sets properties; versions of ParaView differ in those they know."""
    known = proxy.ListProperties()
    for name, value in values.items():
        if name in known:
            setattr(proxy, name, value)


def show_colours(source, view, of_patches=False):
    """Shows the colors of the source in the view just as they are."""
    display = simple.Show(source, view)
    display.Representation = "Surface"
    is_smooth = not of_patches and source.PointData.GetArray("rgb_smooth") is not None
    simple.ColorBy(display, ("POINTS", "rgb_smooth") if is_smooth else ("CELLS", "rgb"))
    # ColorBy has made a color map: leave it out.
    display.MapScalars = 0
    display.SetScalarBarVisibility(view, False)
    # Unlit: where lighting cannot be switched off, all light is ambient and none is reflected.
    set_where_known(display, DisableLighting=1, Ambient=1.0, Diffuse=0.0, Specular=0.0)
    display.BackfaceRepresentation = "Cull Backface"


def plain_background(view):
    """Black, without gradient and axes."""
    set_where_known(
        view,
        UseColorPaletteForBackground=0,
        BackgroundColorMode="Single Color",
        Background=[0.0, 0.0, 0.0],
        OrientationAxesVisibility=0,
    )


def up_axis(source):
    """The model's upright axis, 1 for y and 2 for z, from the field data."""
    up = source.FieldData.GetArray("up")
    return 1 if up is not None and abs(up.GetRange(1)[0]) > 0.5 else 2


def look_at(source, view):
    """From one side, a little from above and from the side, so that everything fits the view."""
    low_x, high_x, low_y, high_y, low_z, high_z = source.GetDataInformation().GetBounds()
    centre = [0.5 * (low_x + high_x), 0.5 * (low_y + high_y), 0.5 * (low_z + high_z)]
    y_is_up = up_axis(source) == 1
    direction = [0.3, 0.3, -1.0] if y_is_up else [-0.3, -1.0, 0.3]
    view.CameraFocalPoint = centre
    view.CameraPosition = [c + d for c, d in zip(centre, direction)]
    view.CameraViewUp = [0, 1, 0] if y_is_up else [0, 0, 1]
    simple.ResetCamera(view)  # keeps the direction, fits the distance


def show(source, screenshot=None, of_patches=False):
    """Shows the source in the active view and, when a name is given, saves a picture."""
    view = simple.GetActiveViewOrCreate("RenderView")
    show_colours(source, view, of_patches)
    plain_background(view)
    look_at(source, view)
    simple.Render(view)
    if screenshot:
        simple.SaveScreenshot(screenshot, view, ImageResolution=[1200, 900])


def main(arguments):
    of_patches = "--patches" in arguments
    arguments = [argument for argument in arguments if argument != "--patches"]
    if len(arguments) not in (1, 2):
        # No exit: it would close ParaView's window.
        print("usage: pvpython paraview_view.py [--patches] result.vtp [screenshot.png]; as a macro: choose a result first")
        return
    reader = simple.XMLPolyDataReader(FileName=[arguments[0]])
    reader.UpdatePipeline()
    if reader.CellData.GetArray("rgb") is None:
        sys.exit(arguments[0] + ": holds no cell array 'rgb'; expected a result of patchlight solve")
    show(reader, arguments[1] if len(arguments) == 2 else None, of_patches)
    if len(arguments) == 1:
        simple.Interact()


# In ParaView's window a macro runs with an active source and without arguments of its own.
active = simple.GetActiveSource()
if active is not None:
    active.UpdatePipeline()
    show(active)
else:
    main(sys.argv[1:])
