#pragma once

#include "output/plot/write_plot.h"

#include <string>
#include <vector>

namespace patchlight {

/// The values on an axis; lower < upper, on a logarithmic axis 0 < lower.
struct AxisRange {
  double lower = 0;
  double upper = 1;
};

/// A mark on an axis. Its label is `text` with `exponent` raised behind it; without a text it has none.
struct Tick {
  double value = 0;
  std::string text;
  std::string exponent;
};

/// Whether an axis can show the value, see write_plot().
bool on_axis(double value, Scale scale);

/// A range that holds all values, which must be on_axis(). On a linear axis the ends are multiples of the step of at
/// most `most` ticks, on a logarithmic one they are a little outside. Without values, or when all are equal, some
/// range.
AxisRange axis_range(const std::vector<double>& values, Scale scale, int most);

/// Ticks within the range, ascending; about `most` (>= 2) have labels. Linear: multiples of 1, 2 or 5 times a power of
/// ten. Logarithmic: powers of ten; 1, 2 and 5 times these where the range holds one or two powers, linear ticks where
/// it is too short for that.
std::vector<Tick> axis_ticks(const AxisRange& range, Scale scale, int most);

/// Where the value stands: 0 is the lower end of the range, 1 the upper.
double place_on_axis(double value, const AxisRange& range, Scale scale);

/// Pixels between a label and its mark.
inline constexpr double label_gap = 8;

/// How a text lies about its place, along its direction.
enum class Align { left, centre, right };

/// A point of the picture, in pixels from the upper left corner.
struct Pixel {
  double x = 0;
  double y = 0;
};

void set_grey(cairo_t* cairo, double grey);

/// Adds a line to the path.
void add_line(cairo_t* cairo, const Pixel& from, const Pixel& to);

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
