#include "output/draw_plot.h"

#include "output/plot_curves.h"
#include "output/plot_text.h"
#include "output/plot_ticks.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

// All lengths in pixels.
constexpr double edge = 16;
constexpr double gap = 8;
constexpr double tick_length = 5;
constexpr double title_size = 16;
constexpr double label_size = 14;
constexpr double number_size = 12;
constexpr double swatch = 36;
constexpr double widest_name = 240;
constexpr double highest_row = 22;
constexpr int most_numbers = 8;
constexpr int most_decades = 12;

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

int most_labels(Scale scale) { return scale == Scale::linear ? most_numbers : most_decades; }

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
    const double room = gap + widest_label(cairo, ticks);
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
  return std::min(highest_row, height / static_cast<double>(std::max<std::size_t>(1, plot.curves.size())));
}

double name_size(double row) { return std::min(number_size, 0.7 * row); }

double legend_width(cairo_t* cairo, const Plot& plot) {
  double width = 0;
  for (const Curve& curve : plot.curves) {
    width = std::max(width, text_width(cairo, fitting_text(cairo, curve.name, widest_name)));
  }
  return plot.curves.empty() ? 0 : 2 * gap + swatch + gap + width;
}

// The frame leaves room for the title above, the legend at the right, numbers and labels at the left and below.
PlotView plot_view(cairo_t* cairo, const Plot& plot) {
  PlotView view{axis_view(plot, 0), axis_view(plot, 1)};
  view.y.from = plot_height - edge - label_size - gap - number_size - gap - tick_length;
  view.y.to = edge + (plot.title.empty() ? 0 : title_size + gap);
  set_text_size(cairo, number_size);
  view.x.from = edge + label_size + gap + widest_label(cairo, view.y.ticks) + gap + tick_length;
  set_text_size(cairo, name_size(row_height(plot, view.y.from - view.y.to)));
  const double legend = legend_width(cairo, plot);
  set_text_size(cairo, number_size);
  view.x.to = plot_width - edge - std::max(legend, widest_label(cairo, view.x.ticks) / 2);
  view.x.ticks = ticks_side_by_side(cairo, view.x);
  return view;
}

void set_grey(cairo_t* cairo, double grey) { cairo_set_source_rgb(cairo, grey, grey, grey); }

void stroke_line(cairo_t* cairo, const Pixel& from, const Pixel& to) {
  cairo_move_to(cairo, from.x, from.y);
  cairo_line_to(cairo, to.x, to.y);
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
  const double to_number = tick_length + (upright ? gap / 2 : gap + number_size / 2);
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
  draw_text(cairo, {view.x.from, edge + title_size / 2 - gap / 2},
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
  const double left = view.x.to + 2 * gap;
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    const double y = view.y.to + (static_cast<double>(k) + 0.5) * row;
    draw_line(cairo, {{left, y}, {left + swatch, y}}, k);
    draw_marker(cairo, {left + swatch / 2, y}, k);
    set_grey(cairo, 0.1);
    draw_text(cairo, {left + swatch + gap, y}, fitting_text(cairo, plot.curves[k].name, widest_name), Align::left);
  }
}

}  // namespace

void draw_plot(cairo_t* cairo, const Plot& plot) {
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  const PlotView view = plot_view(cairo, plot);
  draw_frame(cairo, view);
  draw_curves(cairo, plot, view);
  draw_texts(cairo, plot, view);
  draw_legend(cairo, plot, view);
}

}  // namespace patchlight
