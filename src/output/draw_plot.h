#pragma once

#include "output/write_plot.h"

#include <cairo.h>

namespace patchlight {

inline constexpr int plot_width = 900;
inline constexpr int plot_height = 600;

/// Draws the plot over the whole surface, plot_width x plot_height units. What fails shows in cairo_status().
void draw_plot(cairo_t* cairo, const Plot& plot);

}  // namespace patchlight
