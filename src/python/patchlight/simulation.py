"""Views of a solved scene: report, page and images."""
import html
import json
import warnings

import numpy

from patchlight import _core
from patchlight.options import picture_arguments_of


def report(self):
    """The report as `patchlight solve --json` writes it; docs/reference/outputs/report-json.md lists the keys."""
    return json.loads(self.report_json())


def write_page(self, file):
    """Writes the HTML page, like `patchlight solve --html`."""
    with open(file, "wb") as stream:
        stream.write(self.page())


def picture(self, **options):
    """An image: "srgb" (rows x columns x 3, 8 bits), "radiance" in W/(m^2 sr), "exposure".

    Options of the tool: camera=((x, y, z), (x, y, z), degrees), view, quality, size="WIDTHxHEIGHT",
    exposure=first["exposure"], false_color="luminance".
    """
    return self._picture(picture_arguments_of(options))


def cells(self):
    """The patches for VTK, meshio and pyvista: points (meters), connectivity and offsets of triangles and quadrilaterals.
    Patch i has the corners connectivity[offsets[i]:offsets[i + 1]]."""
    corners = self.corners
    counts = numpy.where(corners[:, 2] == corners[:, 3], 3, 4)
    kept = numpy.arange(4)[None, :] < counts[:, None]
    return {"points": self.vertices, "connectivity": corners[kept], "offsets": numpy.concatenate([[0], numpy.cumsum(counts)])}


def shown_in_notebook(self):
    """The page in its own frame."""
    page = html.escape(self.page().decode("utf-8"), quote=True)
    return f'<iframe srcdoc="{page}" sandbox="allow-scripts" width="100%" height="700" style="border: 0" title="The solved scene"></iframe>'


def described(self):
    return f"<patchlight.Simulation of {self.size} patches>"


_sensors = _core.Simulation.sensors


def sensors(self):
    """Irradiance and illuminance of the scene's sensors with standard errors. Also issues the texts of "warnings"."""
    read = _sensors(self)
    for text in read["warnings"]:
        warnings.warn(text, stacklevel=2)
    return read


_core.Simulation.sensors = sensors
_core.Simulation.cells = cells
_core.Simulation.report = report
_core.Simulation.write_page = write_page
_core.Simulation.picture = picture
_core.Simulation._repr_html_ = shown_in_notebook
_core.Simulation.__repr__ = described
