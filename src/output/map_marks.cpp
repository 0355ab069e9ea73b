#include "output/map_marks.h"

#include "base/shortest.h"
#include "render/tone_map.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

constexpr double ink = 0.1;  // grey of lines and texts

bool meets(const PixelArea& area, const std::array<Pixel, 2>& line) {
  const auto [left, right] = std::minmax(line[0].x, line[1].x);
  const auto [top, bottom] = std::minmax(line[0].y, line[1].y);
  return right >= area.corner.x && left <= area.corner.x + area.width && bottom >= area.corner.y &&
         top <= area.corner.y + area.height;
}

// The largest of 1, 2 and 5 times a power of ten that is not above.
double round_below(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  return (value >= 5 * power ? 5 : value >= 2 * power ? 2 : 1) * power;
}

}  // namespace

void set_false_colour(cairo_t* cairo, double value, const AxisRange& range) {
  const auto colour = false_color(Eigen::VectorXd::Constant(1, value), range.lower, range.upper)[0];
  cairo_set_source_rgb(cairo, colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0);
}

void draw_colours(cairo_t* cairo, const PixelArea& bar, const AxisRange& range, std::span<const Tick> ticks) {
  constexpr int steps = 128;
  constexpr double gap = 8;
  for (int k = 0; k < steps; ++k) {
    set_false_colour(cairo, range.upper - (k + 0.5) / steps * (range.upper - range.lower), range);
    cairo_rectangle(cairo, bar.corner.x, bar.corner.y + k * bar.height / steps, bar.width, bar.height / steps + 0.5);
    cairo_fill(cairo);
  }
  cairo_set_source_rgb(cairo, ink, ink, ink);
  for (const Tick& tick : ticks) {
    const double y = bar.corner.y + bar.height * (1 - place_on_axis(tick.value, range, Scale::linear));
    draw_label(cairo, {bar.corner.x + bar.width + gap, y}, tick, Align::left);
  }
}

void draw_walls(cairo_t* cairo, const PixelArea& area, std::span<const std::array<Pixel, 2>> walls) {
  cairo_save(cairo);
  cairo_rectangle(cairo, area.corner.x, area.corner.y, area.width, area.height);
  cairo_clip(cairo);
  cairo_set_source_rgb(cairo, ink, ink, ink);
  cairo_set_line_width(cairo, 1.5);
  for (const std::array<Pixel, 2>& line : walls) {
    if (!meets(area, line)) continue;
    cairo_move_to(cairo, line[0].x, line[0].y);
    cairo_line_to(cairo, line[1].x, line[1].y);
  }
  cairo_stroke(cairo);
  cairo_restore(cairo);
}

void draw_north(cairo_t* cairo, const Pixel& at) {
  constexpr double half_length = 7, half_width = 3, head = 6;
  const double x = at.x - half_width, top = at.y - half_length;
  cairo_set_source_rgb(cairo, ink, ink, ink);
  cairo_set_line_width(cairo, 1);
  cairo_move_to(cairo, x, at.y + half_length);
  cairo_line_to(cairo, x, top);
  cairo_stroke(cairo);
  cairo_move_to(cairo, x, top);
  cairo_line_to(cairo, x + half_width, top + head);
  cairo_line_to(cairo, x - half_width, top + head);
  cairo_close_path(cairo);
  cairo_fill(cairo);
  draw_text(cairo, {x - 2 * half_width, at.y}, "N", Align::right);
}

void draw_scale_bar(cairo_t* cairo, const Pixel& at, double pixels_per_metre, double most) {
  constexpr double end = 4, gap = 8;  // half the height of the bar's ends
  const double metres = round_below(most / pixels_per_metre);
  const double right = at.x + metres * pixels_per_metre;
  cairo_set_source_rgb(cairo, ink, ink, ink);
  cairo_set_line_width(cairo, 1.5);
  cairo_move_to(cairo, at.x, at.y - end);
  cairo_line_to(cairo, at.x, at.y + end);
  cairo_move_to(cairo, at.x, at.y);
  cairo_line_to(cairo, right, at.y);
  cairo_move_to(cairo, right, at.y - end);
  cairo_line_to(cairo, right, at.y + end);
  cairo_stroke(cairo);
  draw_text(cairo, {right + gap, at.y}, shortest(metres) + " m", Align::left);
}

}  // namespace patchlight
