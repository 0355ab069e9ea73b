#pragma once

#include "output/plot/plot_ticks.h"

#include <cairo.h>
#include <string>

namespace patchlight {

/// How a text lies about its place, along its direction.
enum class Align { left, centre, right };

/// A point of the picture, in pixels from the upper left corner.
struct Pixel {
  double x = 0;
  double y = 0;
};

/// Sets the size of the texts that follow, in pixels.
void set_text_size(cairo_t* cairo, double size);

double text_width(cairo_t* cairo, const std::string& text);

/// The text as UTF-8, bytes that are none replaced; when it is wider than `width`, its end is cut off and marked by
/// "...".
std::string fitting_text(cairo_t* cairo, const std::string& text, double width);

/// Draws one line of text, halfway up at `at`.
void draw_text(cairo_t* cairo, const Pixel& at, const std::string& text, Align align);

/// The same with the label of a tick, its exponent raised.
void draw_label(cairo_t* cairo, const Pixel& at, const Tick& tick, Align align);

double label_width(cairo_t* cairo, const Tick& tick);

}  // namespace patchlight
