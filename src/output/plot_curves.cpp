#include "output/plot_curves.h"

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace patchlight {
namespace {

// Okabe and Ito, "Color Universal Design" (2008), without the yellow, which is too light on white: the eyes of the
// colour-blind tell them apart. 7 colours and 8 markers: the pairs repeat after 56 curves only.
constexpr std::array<std::array<double, 3>, 7> curve_colours = {{{0, 0.447, 0.698},
                                                                 {0.835, 0.369, 0},
                                                                 {0, 0.620, 0.451},
                                                                 {0.800, 0.475, 0.655},
                                                                 {0.902, 0.624, 0},
                                                                 {0.337, 0.706, 0.914},
                                                                 {0, 0, 0}}};
// Every seven curves other dashes: lengths of lines and gaps in pixels.
const std::array<std::vector<double>, 4> dashes = {{{}, {8, 4}, {2.5, 3}, {10, 3, 2.5, 3}}};

constexpr double line_width = 1.8;
constexpr double marker_size = 4;
constexpr double marker_distance = 60;

enum class Marker { circle, square, triangle, diamond, turned_triangle, star, pentagon, cross };
constexpr std::size_t markers = 8;
static_assert(std::gcd(curve_colours.size(), markers) == 1, "else pairs of colour and marker repeat earlier");

void set_colour(cairo_t* cairo, std::size_t curve) {
  const auto [red, green, blue] = curve_colours[curve % curve_colours.size()];
  cairo_set_source_rgb(cairo, red, green, blue);
}

// `corners` points on a circle, the first one at `angle` from the top; at every second one only `depth` of the radius.
struct Star {
  int corners = 4;
  double angle = 0;
  double depth = 1;
};

void trace_star(cairo_t* cairo, const Pixel& at, const Star& star) {
  const double radius = (star.depth < 1 ? 1.5 : 1.25) * marker_size;
  for (int k = 0; k < star.corners; ++k) {
    const double angle = star.angle + 2 * std::numbers::pi * k / star.corners;
    const double distance = k % 2 == 0 ? radius : star.depth * radius;
    cairo_line_to(cairo, at.x + distance * std::sin(angle), at.y - distance * std::cos(angle));
  }
  cairo_close_path(cairo);
}

void trace_marker(cairo_t* cairo, const Pixel& at, Marker marker) {
  using std::numbers::pi;
  switch (marker) {
    case Marker::circle:
      return cairo_arc(cairo, at.x, at.y, marker_size, 0, 2 * pi);
    case Marker::square:
      return trace_star(cairo, at, {4, pi / 4});
    case Marker::triangle:
      return trace_star(cairo, at, {3, 0});
    case Marker::diamond:
      return trace_star(cairo, at, {4, 0});
    case Marker::turned_triangle:
      return trace_star(cairo, at, {3, pi});
    case Marker::star:
      return trace_star(cairo, at, {10, 0, 0.45});
    case Marker::pentagon:
      return trace_star(cairo, at, {5, 0});
    case Marker::cross:
      return trace_star(cairo, at, {8, pi / 4, 0.45});
  }
}

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace

void draw_line(cairo_t* cairo, const std::vector<Pixel>& points, std::size_t curve) {
  for (const Pixel& point : points) cairo_line_to(cairo, point.x, point.y);
  const std::vector<double>& pattern = dashes[curve / curve_colours.size() % dashes.size()];
  set_colour(cairo, curve);
  cairo_set_dash(cairo, pattern.data(), static_cast<int>(pattern.size()), 0);
  cairo_set_line_width(cairo, line_width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(cairo);
  cairo_set_dash(cairo, nullptr, 0, 0);
}

void draw_marker(cairo_t* cairo, const Pixel& at, std::size_t curve) {
  // A white edge sets it off from the lines below.
  trace_marker(cairo, at, static_cast<Marker>(curve % markers));
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_set_line_width(cairo, 1.5);
  cairo_stroke_preserve(cairo);
  set_colour(cairo, curve);
  cairo_fill(cairo);
}

std::vector<Pixel> marked_points(const std::vector<Pixel>& points, std::size_t curve) {
  if (points.empty()) return {};
  std::vector<Pixel> marked;
  double since_last = marker_distance * static_cast<double>(curve % markers) / markers;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    since_last += distance(points[k - 1], points[k]);
    if (since_last < marker_distance) continue;
    marked.push_back(points[k]);
    since_last = 0;
  }
  if (!marked.empty() && distance(marked.back(), points.back()) < marker_distance / 3) marked.pop_back();
  marked.push_back(points.back());
  return marked;
}

}  // namespace patchlight
