#include "output/plot/write_plot.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/plot/plot_ticks.h"

#include <algorithm>
#include <cairo-svg.h>
#include <cairo.h>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

constexpr int plot_width = 900;
constexpr int plot_height = 600;

// Okabe and Ito, "Color Universal Design" (2008), without the yellow, which is too light on white. Color-blind readers
// can distinguish these colors. With 7 colors and 8 markers, pairs repeat after 56 curves only.
constexpr std::array<std::array<double, 3>, 7> curve_colours = {{{0, 0.447, 0.698},
                                                                 {0.835, 0.369, 0},
                                                                 {0, 0.620, 0.451},
                                                                 {0.800, 0.475, 0.655},
                                                                 {0.902, 0.624, 0},
                                                                 {0.337, 0.706, 0.914},
                                                                 {0, 0, 0}}};
// Every seven curves other dashes: lengths of lines and gaps in pixels.
const std::array<std::vector<double>, 4> dashes = {{{}, {8, 4}, {2.5, 3}, {10, 3, 2.5, 3}}};

constexpr double marker_size = 4;
constexpr double marker_distance = 60;

void set_colour(cairo_t* cairo, std::size_t curve) {
  const auto [red, green, blue] = curve_colours[curve % curve_colours.size()];
  cairo_set_source_rgb(cairo, red, green, blue);
}

// `corners` points on a circle, the first one at `angle` from the top; at every second one only `depth` of the radius.
struct Star {
  int corners = 0;  // none: a circle
  double angle = 0;
  double depth = 1;
};

// Circle, square, triangle, diamond, turned triangle, star, pentagon and cross.
constexpr std::array<Star, 8> markers = {{{},
                                          {4, std::numbers::pi / 4},
                                          {3},
                                          {4},
                                          {3, std::numbers::pi},
                                          {10, 0, 0.45},
                                          {5},
                                          {8, std::numbers::pi / 4, 0.45}}};
static_assert(std::gcd(curve_colours.size(), markers.size()) == 1, "else pairs of color and marker repeat earlier");

void trace_marker(cairo_t* cairo, const Pixel& at, const Star& star) {
  if (star.corners == 0) return cairo_arc(cairo, at.x, at.y, marker_size, 0, 2 * std::numbers::pi);
  const double radius = (star.depth < 1 ? 1.5 : 1.25) * marker_size;
  for (int k = 0; k < star.corners; ++k) {
    const double angle = star.angle + 2 * std::numbers::pi * k / star.corners;
    const double distance = k % 2 == 0 ? radius : star.depth * radius;
    cairo_line_to(cairo, at.x + distance * std::sin(angle), at.y - distance * std::cos(angle));
  }
  cairo_close_path(cairo);
}

double distance(const Pixel& a, const Pixel& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// Draws a line through the points, in the color and the dashes of the curve of this number.
void draw_line(cairo_t* cairo, const std::vector<Pixel>& points, std::size_t curve) {
  for (const Pixel& point : points) cairo_line_to(cairo, point.x, point.y);
  const std::vector<double>& pattern = dashes[curve / curve_colours.size() % dashes.size()];
  set_colour(cairo, curve);
  cairo_set_dash(cairo, pattern.data(), static_cast<int>(pattern.size()), 0);
  cairo_set_line_width(cairo, 1.8);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(cairo);
  cairo_set_dash(cairo, nullptr, 0, 0);
}

// Draws a marker in the color and the shape of the curve of this number.
void draw_marker(cairo_t* cairo, const Pixel& at, std::size_t curve) {
  // A white edge sets it off from the lines below.
  trace_marker(cairo, at, markers[curve % markers.size()]);
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_set_line_width(cairo, 1.5);
  cairo_stroke_preserve(cairo);
  set_colour(cairo, curve);
  cairo_fill(cairo);
}

// The points that get a marker: along the line some distance apart, at other places on neighboring curves, and the
// last.
std::vector<Pixel> marked_points(const std::vector<Pixel>& points, std::size_t curve) {
  if (points.empty()) return {};
  std::vector<Pixel> marked;
  double since_last =
      marker_distance * static_cast<double>(curve % markers.size()) / static_cast<double>(markers.size());
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

// All lengths in pixels.
constexpr double edge = 16;
constexpr double tick_length = 5;
constexpr double title_size = 16;
constexpr double label_size = 14;
constexpr double number_size = 12;
constexpr double swatch = 36;
constexpr double widest_name = 240;

// An axis and where its ends lie in the picture.
struct AxisView {
  AxisRange range;
  Scale scale = Scale::linear;
  std::vector<Tick> ticks;
  double from = 0;  // pixel of the lower end
  double to = 1;    // pixel of the upper end

  double pixel(double value) const { return from + (to - from) * place_on_axis(value, range, scale); }
};

struct PlotView {
  AxisView x;
  AxisView y;
};

using Points = std::vector<std::array<double, 2>>;

Points shown_points(const Curve& curve, const Plot& plot) {
  Points points = curve.points;
  std::erase_if(points, [&](const auto& p) { return !on_axis(p[0], plot.x.scale) || !on_axis(p[1], plot.y.scale); });
  return points;
}

int most_labels(Scale scale) { return scale == Scale::linear ? 8 : 12; }

AxisView axis_view(const Plot& plot, std::size_t coordinate) {
  std::vector<double> values;
  for (const Curve& curve : plot.curves) {
    for (const auto& point : shown_points(curve, plot)) values.push_back(point[coordinate]);
  }
  const Scale scale = coordinate == 0 ? plot.x.scale : plot.y.scale;
  const int most = most_labels(scale);
  const AxisRange range = axis_range(values, scale, most);
  return {range, scale, axis_ticks(range, scale, most)};
}

double widest_label(cairo_t* cairo, const std::vector<Tick>& ticks) {
  double width = 0;
  for (const Tick& tick : ticks) width = std::max(width, label_width(cairo, tick));
  return width;
}

// Ticks so few that labels side by side do not touch.
std::vector<Tick> ticks_side_by_side(cairo_t* cairo, const AxisView& axis) {
  std::vector<Tick> ticks = axis.ticks;
  for (int most = most_labels(axis.scale); most > 2; --most) {
    ticks = axis_ticks(axis.range, axis.scale, most);
    const double room = label_gap + widest_label(cairo, ticks);
    double last = axis.from - room;
    const bool touching = std::any_of(ticks.begin(), ticks.end(), [&](const Tick& tick) {
      if (tick.text.empty()) return false;
      const double before = std::exchange(last, axis.pixel(tick.value));
      return last - before < room;
    });
    if (!touching) break;
  }
  return ticks;
}

double row_height(const Plot& plot, double height) {
  return std::min(22.0, height / static_cast<double>(std::max<std::size_t>(1, plot.curves.size())));
}

double name_size(double row) { return std::min(number_size, 0.7 * row); }

double legend_width(cairo_t* cairo, const Plot& plot) {
  double width = 0;
  for (const Curve& curve : plot.curves) {
    width = std::max(width, text_width(cairo, fitting_text(cairo, curve.name, widest_name)));
  }
  return plot.curves.empty() ? 0 : 2 * label_gap + swatch + label_gap + width;
}

// The frame leaves room for the title above, the legend at the right, numbers and labels at the left and below.
PlotView plot_view(cairo_t* cairo, const Plot& plot) {
  PlotView view{axis_view(plot, 0), axis_view(plot, 1)};
  view.y.from = plot_height - edge - label_size - label_gap - number_size - label_gap - tick_length;
  view.y.to = edge + (plot.title.empty() ? 0 : title_size + label_gap);
  set_text_size(cairo, number_size);
  view.x.from = edge + label_size + label_gap + widest_label(cairo, view.y.ticks) + label_gap + tick_length;
  set_text_size(cairo, name_size(row_height(plot, view.y.from - view.y.to)));
  const double legend = legend_width(cairo, plot);
  set_text_size(cairo, number_size);
  view.x.to = plot_width - edge - std::max(legend, widest_label(cairo, view.x.ticks) / 2);
  view.x.ticks = ticks_side_by_side(cairo, view.x);
  return view;
}

void stroke_line(cairo_t* cairo, const Pixel& from, const Pixel& to) {
  add_line(cairo, from, to);
  cairo_stroke(cairo);
}

// A place `along` an axis and `across` it.
Pixel place(bool upright, double along, double across) { return upright ? Pixel{across, along} : Pixel{along, across}; }

// Lines at the ticks of an axis, from end to end of the other one; lighter ones at those without a label.
void draw_grid(cairo_t* cairo, const AxisView& axis, const AxisView& other, bool upright) {
  cairo_set_line_width(cairo, 1);
  for (const Tick& tick : axis.ticks) {
    const double along = axis.pixel(tick.value);
    set_grey(cairo, tick.text.empty() ? 0.945 : 0.85);
    stroke_line(cairo, place(upright, along, other.from), place(upright, along, other.to));
  }
}

// Ticks out of the frame, with their numbers: below the axis, or left of the upright one.
void draw_ticks(cairo_t* cairo, const AxisView& axis, double edge_of_frame, bool upright) {
  const double out = upright ? -1 : 1;
  const double to_number = tick_length + (upright ? label_gap / 2 : label_gap + number_size / 2);
  for (const Tick& tick : axis.ticks) {
    const double along = axis.pixel(tick.value), length = tick.text.empty() ? tick_length / 2 : tick_length;
    stroke_line(cairo, place(upright, along, edge_of_frame), place(upright, along, edge_of_frame + out * length));
    draw_label(cairo, place(upright, along, edge_of_frame + out * to_number), tick,
               upright ? Align::right : Align::centre);
  }
}

void draw_frame(cairo_t* cairo, const PlotView& view) {
  draw_grid(cairo, view.x, view.y, false);
  draw_grid(cairo, view.y, view.x, true);
  set_grey(cairo, 0.2);
  cairo_rectangle(cairo, view.x.from, view.y.to, view.x.to - view.x.from, view.y.from - view.y.to);
  cairo_stroke(cairo);
  set_text_size(cairo, number_size);
  draw_ticks(cairo, view.x, view.y.from, false);
  draw_ticks(cairo, view.y, view.x.from, true);
}

void draw_texts(cairo_t* cairo, const Plot& plot, const PlotView& view) {
  const double width = view.x.to - view.x.from, height = view.y.from - view.y.to;
  set_grey(cairo, 0.1);
  set_text_size(cairo, title_size);
  draw_text(cairo, {view.x.from, edge + title_size / 2 - label_gap / 2},
            fitting_text(cairo, plot.title, plot_width - edge - view.x.from), Align::left);
  set_text_size(cairo, label_size);
  draw_text(cairo, {view.x.from + width / 2, plot_height - edge - label_size / 2},
            fitting_text(cairo, plot.x.label, width), Align::centre);
  // Upward at the left.
  cairo_save(cairo);
  cairo_translate(cairo, edge + label_size / 2, view.y.to + height / 2);
  cairo_rotate(cairo, -std::numbers::pi / 2);
  draw_text(cairo, {0, 0}, fitting_text(cairo, plot.y.label, height), Align::centre);
  cairo_restore(cairo);
}

void draw_curves(cairo_t* cairo, const Plot& plot, const PlotView& view) {
  std::vector<std::vector<Pixel>> lines;
  for (const Curve& curve : plot.curves) {
    std::vector<Pixel>& line = lines.emplace_back();
    for (const auto& [x, y] : shown_points(curve, plot)) line.push_back({view.x.pixel(x), view.y.pixel(y)});
  }
  for (std::size_t k = 0; k < lines.size(); ++k) draw_line(cairo, lines[k], k);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    for (const Pixel& point : marked_points(lines[k], k)) draw_marker(cairo, point, k);
  }
}

void draw_legend(cairo_t* cairo, const Plot& plot, const PlotView& view) {
  const double row = row_height(plot, view.y.from - view.y.to);
  set_text_size(cairo, name_size(row));
  const double left = view.x.to + 2 * label_gap;
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const double y = view.y.to + (static_cast<double>(k) + 0.5) * row;
    draw_line(cairo, {{left, y}, {left + swatch, y}}, k);
    draw_marker(cairo, {left + swatch / 2, y}, k);
    set_grey(cairo, 0.1);
    draw_text(cairo, {left + swatch + label_gap, y}, fitting_text(cairo, plot.curves[k].name, widest_name),
              Align::left);
  }
}

// Draws the plot over the whole surface, plot_width x plot_height units. Failures show in cairo_status().
void draw_plot(cairo_t* cairo, const Plot& plot) {
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  const PlotView view = plot_view(cairo, plot);
  draw_frame(cairo, view);
  draw_curves(cairo, plot, view);
  draw_texts(cairo, plot, view);
  draw_legend(cairo, plot, view);
}

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
};

struct Drawing {
  int width, height;
  const std::function<void(cairo_t*)>& draw;
};

using Surface = std::unique_ptr<cairo_surface_t, Destroy>;

cairo_status_t append(void* bytes, const unsigned char* more, unsigned int count) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(more), count);
  return CAIRO_STATUS_SUCCESS;
}

void check(cairo_status_t status, const std::filesystem::path& file) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw OutputError(file.string(), std::string("the drawing cannot be drawn: ") + cairo_status_to_string(status));
}

void draw_on(const Surface& surface, const Drawing& drawing, const std::filesystem::path& file) {
  const std::unique_ptr<cairo_t, Destroy> cairo(cairo_create(surface.get()));
  drawing.draw(cairo.get());
  check(cairo_status(cairo.get()), file);
}

std::string png_bytes(const Drawing& drawing, const std::filesystem::path& file) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, drawing.width, drawing.height));
  draw_on(surface, drawing, file);
  std::string bytes;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &bytes), file);
  return bytes;
}

// cairo names the outermost group after a number that counts the surfaces of the process: it would differ from file to
// file.
std::string without_surface_number(std::string svg) {
  const std::string name = "id=\"surface";
  const std::size_t begin = svg.find(name);
  if (begin == std::string::npos) return svg;
  const std::size_t number = begin + name.size();
  return svg.erase(number, svg.find('"', number) - number);
}

std::string svg_bytes(const Drawing& drawing, const std::filesystem::path& file) {
  std::string bytes;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &bytes, drawing.width, drawing.height));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
  draw_on(surface, drawing, file);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()), file);
  return without_surface_number(std::move(bytes));
}

}  // namespace

void write_plot(const std::filesystem::path& file, const Plot& plot) {
  if (file.extension() != ".svg" && file.extension() != ".png")
    throw OutputError(file.string(), "the extension names no known format of plots; expected .svg or .png");
  write_drawing(file, plot_width, plot_height, [&](cairo_t* cairo) { draw_plot(cairo, plot); });
}

void write_drawing(const std::filesystem::path& file, int width, int height,
                   const std::function<void(cairo_t*)>& draw) {
  const Drawing drawing{width, height, draw};
  const std::string extension = file.extension().string();
  if (extension == ".svg") return write_bytes(file, svg_bytes(drawing, file));
  if (extension == ".png") return write_bytes(file, png_bytes(drawing, file));
  throw OutputError(file.string(), "the extension names no known format of drawings; expected .svg or .png");
}

}  // namespace patchlight
