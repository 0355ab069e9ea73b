#pragma once

#include "output/plot_text.h"

#include <cairo.h>
#include <cstddef>
#include <vector>

namespace patchlight {

/// Draws a line through the points, in the colour and the dashes of the curve of this number.
void draw_line(cairo_t* cairo, const std::vector<Pixel>& points, std::size_t curve);

/// Draws a marker in the colour and the shape of the curve of this number.
void draw_marker(cairo_t* cairo, const Pixel& at, std::size_t curve);

/// The points that get a marker: along the line some distance apart, at other places on neighbouring curves, and the
/// last.
std::vector<Pixel> marked_points(const std::vector<Pixel>& points, std::size_t curve);

}  // namespace patchlight
