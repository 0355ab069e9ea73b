#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

using cairo_t = struct _cairo;  // NOLINT(bugprone-reserved-identifier): a name of cairo.h

namespace patchlight {

/// A line through points (x, y), in their order; a lone point is a marker.
struct Curve {
  std::string name;
  std::vector<std::array<double, 2>> points;
};

/// How an axis is divided.
enum class Scale { linear, logarithmic };

/// One axis of a plot.
struct Axis {
  std::string label;
  Scale scale = Scale::linear;
};

/// Curves over common axes, which reach as far as the points. The first 56 curves differ in color, dashes or markers.
struct Plot {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Curve> curves;
};

/// Writes the plot, 900 x 600 pixels, as .svg or .png after the extension; no display is needed. The same plot gives
/// the same bytes. Points that an axis cannot show are left out: values that are not finite or larger than 1e200 in
/// size, on a logarithmic axis also those below 1e-200. Texts are UTF-8; too long ones are cut. \throws
/// OutputError, also for another extension.
void write_plot(const std::filesystem::path& file, const Plot& plot);

/// Writes a drawing of so many pixels, by the extension of the file: .svg or .png. The same bytes on every run.
/// \throws OutputError.
void write_drawing(const std::filesystem::path& file, int width, int height, const std::function<void(cairo_t*)>& draw);

}  // namespace patchlight
