#pragma once

#include "output/plot_text.h"
#include "output/plot_ticks.h"

#include <array>
#include <cairo.h>
#include <span>
#include <string>

namespace patchlight {

/// A rectangle of the drawing: its upper left corner, and its size.
struct PixelArea {
  Pixel corner;
  double width = 0;
  double height = 0;
};

/// Sets the false colour of a value.
void set_false_colour(cairo_t* cairo, double value, const AxisRange& range);

/// Draws the bar of false colours with labels at these ticks.
void draw_colours(cairo_t* cairo, const PixelArea& bar, const AxisRange& range, std::span<const Tick> ticks);

/// Draws what of these lines lies in the area.
void draw_walls(cairo_t* cairo, const PixelArea& area, std::span<const std::array<Pixel, 2>> walls);

/// Draws an arrow upwards with an N, its right end halfway up at `at`.
void draw_north(cairo_t* cairo, const Pixel& at);

/// Draws a bar of a round number of metres from `at` to the right, `most` pixels at most, with its length.
void draw_scale_bar(cairo_t* cairo, const Pixel& at, double pixels_per_metre, double most);

}  // namespace patchlight
