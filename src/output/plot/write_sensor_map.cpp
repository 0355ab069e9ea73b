#include "output/plot/write_sensor_map.h"

#include "patchlight/base/error.h"

#include "base/words.h"
#include "output/plot/plot_ticks.h"
#include "output/plot/write_plot.h"
#include "render/tone_map.h"

#include <algorithm>
#include <cairo.h>
#include <cassert>
#include <cstddef>
#include <limits>
#include <string>

namespace patchlight {
namespace {

// Where the level is crossed around a square, corner after corner.
std::vector<Eigen::Vector2d> crossings(const std::array<double, 4>& values, double column, double row, double level) {
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d(column, row), Eigen::Vector2d(column + 1, row),
                                                  Eigen::Vector2d(column + 1, row + 1),
                                                  Eigen::Vector2d(column, row + 1)};
  std::vector<Eigen::Vector2d> found;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    if ((values[k] >= level) == (values[next] >= level)) continue;
    const double part = (level - values[k]) / (values[next] - values[k]);
    found.push_back((1 - part) * corners[k] + part * corners[next]);
  }
  return found;
}

// The lattice that the cells of a grid lie on.
struct SensorLattice {
  Eigen::MatrixXd values;  // not a number where there is no sensor; none where the sensors lie on no lattice
  Point origin;            // of column and row 0
  Vector step, step_of_rows;
};

// That of a grid whose first cell is this.
SensorLattice lattice_of(const std::vector<Sensor>& sensors, const std::array<Point, 4>& cell,
                         const std::vector<double>& values) {
  SensorLattice lattice{{}, sensors[0].point, cell[1] - cell[0], cell[3] - cell[0]};
  const auto place = [&](const Point& point) -> Eigen::Vector2d {
    const Vector way = point - lattice.origin;
    return {way.dot(lattice.step) / lattice.step.squaredNorm(),
            way.dot(lattice.step_of_rows) / lattice.step_of_rows.squaredNorm()};
  };
  Eigen::Vector2d low(0, 0), high(0, 0);
  for (const Sensor& sensor : sensors) {
    low = low.cwiseMin(place(sensor.point));
    high = high.cwiseMax(place(sensor.point));
  }
  const Eigen::Vector2d size = (high - low).array().round() + 1;
  // More places than a file can show: cells of several sizes, or not in one plane
  if (!(size.prod() < 100.0 * static_cast<double>(sensors.size()) + 1000)) return lattice;
  lattice.values = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(size[1]), static_cast<Eigen::Index>(size[0]),
                                             std::numeric_limits<double>::quiet_NaN());
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    const Eigen::Vector2d at = (place(sensors[k].point) - low).array().round();
    lattice.values(static_cast<Eigen::Index>(at[1]), static_cast<Eigen::Index>(at[0])) = values[k];
  }
  lattice.origin += low[0] * lattice.step + low[1] * lattice.step_of_rows;
  return lattice;
}

// A rectangle of the drawing: its upper left corner, and its size.
struct PixelArea {
  Pixel corner;
  double width = 0;
  double height = 0;
};

constexpr double ink = 0.1;  // gray of lines and texts

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

// Sets the false color of a value.
void set_false_colour(cairo_t* cairo, double value, const AxisRange& range) {
  const auto colour = false_color(Eigen::VectorXd::Constant(1, value), range.lower, range.upper)[0];
  cairo_set_source_rgb(cairo, colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0);
}

// Draws the bar of false colors with labels at these ticks.
void draw_colours(cairo_t* cairo, const PixelArea& bar, const AxisRange& range, std::span<const Tick> ticks) {
  const int steps = 128;
  for (int k = 0; k < steps; ++k) {
    set_false_colour(cairo, range.upper - (k + 0.5) / steps * (range.upper - range.lower), range);
    cairo_rectangle(cairo, bar.corner.x, bar.corner.y + k * bar.height / steps, bar.width, bar.height / steps + 0.5);
    cairo_fill(cairo);
  }
  set_grey(cairo, ink);
  for (const Tick& tick : ticks) {
    const double y = bar.corner.y + bar.height * (1 - place_on_axis(tick.value, range, Scale::linear));
    draw_label(cairo, {bar.corner.x + bar.width + label_gap, y}, tick, Align::left);
  }
}

// Draws the parts of these lines in the area.
void draw_walls(cairo_t* cairo, const PixelArea& area, std::span<const std::array<Pixel, 2>> walls) {
  cairo_save(cairo);
  cairo_rectangle(cairo, area.corner.x, area.corner.y, area.width, area.height);
  cairo_clip(cairo);
  set_grey(cairo, ink);
  cairo_set_line_width(cairo, 1.5);
  for (const std::array<Pixel, 2>& line : walls) {
    if (meets(area, line)) add_line(cairo, line[0], line[1]);
  }
  cairo_stroke(cairo);
  cairo_restore(cairo);
}

// Draws an arrow upwards with an N, its right end halfway up at `at`.
void draw_north(cairo_t* cairo, const Pixel& at) {
  const double half_length = 7, half_width = 3, head = 6;
  const double x = at.x - half_width, top = at.y - half_length;
  set_grey(cairo, ink);
  cairo_set_line_width(cairo, 1);
  add_line(cairo, {x, at.y + half_length}, {x, top});
  cairo_stroke(cairo);
  add_line(cairo, {x, top}, {x + half_width, top + head});
  cairo_line_to(cairo, x - half_width, top + head);
  cairo_close_path(cairo);
  cairo_fill(cairo);
  draw_text(cairo, {x - 2 * half_width, at.y}, "N", Align::right);
}

// Draws a bar of a round number of meters from `at` to the right, `most` pixels at most, with its length.
void draw_scale_bar(cairo_t* cairo, const Pixel& at, double pixels_per_metre, double most) {
  const double end = 4;  // half the height of the bar's ends
  const double metres = round_below(most / pixels_per_metre);
  const double right = at.x + metres * pixels_per_metre;
  set_grey(cairo, ink);
  cairo_set_line_width(cairo, 1.5);
  add_line(cairo, {at.x, at.y - end}, {at.x, at.y + end});
  add_line(cairo, at, {right, at.y});
  add_line(cairo, {right, at.y - end}, {right, at.y + end});
  cairo_stroke(cairo);
  draw_text(cairo, {right + label_gap, at.y}, shortest(metres) + " m", Align::left);
}

// All lengths in pixels.
constexpr double map_edge = 24;
constexpr double highest_map = 420;
constexpr double line_height = 18;
constexpr double map_text = 12;
constexpr int most_levels = 9;

// One grid, with its axes and readings.
struct GridMap {
  const SensorGroup* group = nullptr;
  std::vector<std::array<Point, 4>> cells;
  std::vector<double> values;
  std::span<const std::array<Point, 2>> walls;      // that stand where the grid's plane cuts the model
  Vector right, above;                              // unit
  double left = 0, top = 0, width = 0, height = 0;  // along these, meters
};

// Where things stand in the file.
struct Placed {
  double x = 0, y = 0, scale = 1;  // of the map's upper left corner; pixels per meter
};

// Squares around sensors without cells in their file, as wide as the distance of the two nearest; none around few.
std::vector<std::array<Point, 4>> squares_around(const std::vector<Sensor>& sensors, const GridMap& map) {
  if (sensors.size() < 4 || sensors.size() > 20000) return {};
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    for (std::size_t other = 0; other < k; ++other) {
      const double apart = (sensors[k].point - sensors[other].point).norm();
      if (apart > 0) step = std::min(step, apart);
    }
  }
  if (!std::isfinite(step)) return {};
  const Vector across = step / 2 * map.right, upward = step / 2 * map.above;
  std::vector<std::array<Point, 4>> cells;
  for (const Sensor& sensor : sensors) {
    const Point& at = sensor.point;
    cells.push_back({at - across - upward, at + across - upward, at + across + upward, at - across + upward});
  }
  return cells;
}

GridMap grid_map(const SensorGroup& group, std::vector<double> values, std::span<const std::array<Point, 2>> walls,
                 const MapOptions& options) {
  GridMap map{&group, group.cells, std::move(values), walls, {}, {}};
  const MapAxes axes = map_axes(group.sensors[0].normal, options.up, options.north);
  map.right = axes.right;
  map.above = axes.above;
  if (map.cells.empty()) map.cells = squares_around(group.sensors, map);
  Eigen::AlignedBox2d box;
  for (const auto& cell : map.cells) {
    for (const Point& corner : cell) box.extend(Eigen::Vector2d(corner.dot(map.right), -corner.dot(map.above)));
  }
  map.left = box.min().x();
  map.top = box.min().y();
  map.width = box.sizes().x();
  map.height = box.sizes().y();
  // Walls stand a little way off.
  const double margin = walls.empty() ? 0 : 0.1 * (map.width + map.height);
  map.left -= margin;
  map.top -= margin;
  map.width += 2 * margin;
  map.height += 2 * margin;
  return map;
}

std::vector<GridMap> grid_maps(std::span<const SensorGroup> groups, const Readings& readings,
                               const MapOptions& options) {
  std::vector<GridMap> maps;
  std::size_t sensor = 0;
  for (std::size_t number = 0; number < groups.size(); ++number) {
    const SensorGroup& group = groups[number];
    std::vector<double> values;
    for (std::size_t k = 0; k < group.sensors.size(); ++k, ++sensor) {
      const bool is_inside = is_inside_wall(readings, sensor);
      values.push_back(is_inside                                          ? std::numeric_limits<double>::quiet_NaN()
                       : options.quantity == MapQuantity::daylight_factor ? daylight_factor(readings, sensor)
                                                                          : sensor_value(readings, sensor).value);
    }
    if (group.sensors.empty() || maps.size() >= 64) continue;
    std::span<const std::array<Point, 2>> walls;
    assert(options.sections.empty() || number < options.sections.size());
    if (!options.sections.empty()) walls = options.sections[number];
    GridMap map = grid_map(group, std::move(values), walls, options);
    if (!map.cells.empty()) maps.push_back(std::move(map));
  }
  return maps;
}

AxisRange range_of(const std::vector<GridMap>& maps, const MapOptions& options) {
  if (options.range) return {(*options.range)[0], (*options.range)[1]};
  std::vector<double> values = {0};
  for (const GridMap& map : maps) {
    for (const double value : map.values)
      if (std::isfinite(value)) values.push_back(value);
  }
  return axis_range(values, Scale::linear, most_levels);
}

Pixel pixel_of(const GridMap& map, const Placed& at, const Point& point) {
  return {at.x + (point.dot(map.right) - map.left) * at.scale, at.y + (-point.dot(map.above) - map.top) * at.scale};
}

void draw_cells(cairo_t* cairo, const GridMap& map, const Placed& at, const AxisRange& range) {
  for (std::size_t k = 0; k < map.values.size(); ++k) {
    cairo_new_path(cairo);
    for (const Point& corner : map.cells[k]) {
      const Pixel pixel = pixel_of(map, at, corner);
      cairo_line_to(cairo, pixel.x, pixel.y);
    }
    cairo_close_path(cairo);
    if (std::isfinite(map.values[k]))
      set_false_colour(cairo, map.values[k], range);
    else
      set_grey(cairo, 0.8);
    cairo_fill_preserve(cairo);
    // Over the seam to the next cell
    cairo_set_line_width(cairo, 0.6);
    cairo_stroke(cairo);
  }
}

// A label in a gap of its line.
void draw_level(cairo_t* cairo, const Pixel& at, const Tick& tick) {
  const double half = label_width(cairo, tick) / 2 + 2;
  cairo_set_source_rgba(cairo, 1, 1, 1, 0.75);
  cairo_rectangle(cairo, at.x - half, at.y - map_text / 2, 2 * half, map_text);
  cairo_fill(cairo);
  set_grey(cairo, 0);
  draw_label(cairo, at, tick, Align::centre);
}

void draw_isolines(cairo_t* cairo, const GridMap& map, const Placed& at, const std::vector<Tick>& levels) {
  const SensorLattice lattice = lattice_of(map.group->sensors, map.cells[0], map.values);
  const auto pixel = [&](const Eigen::Vector2d& place) {
    return pixel_of(map, at, lattice.origin + place[0] * lattice.step + place[1] * lattice.step_of_rows);
  };
  for (const Tick& level : levels) {
    const std::vector<IsolinePiece> pieces = isoline(lattice.values, level.value);
    if (pieces.empty()) continue;
    set_grey(cairo, 0);
    cairo_set_line_width(cairo, 1);
    for (const auto& [from, to] : pieces) {
      add_line(cairo, pixel(from), pixel(to));
    }
    cairo_stroke(cairo);
    const auto& [from, to] = pieces[pieces.size() / 2];
    if (!level.text.empty()) draw_level(cairo, pixel((from + to) / 2), level);
  }
}

void draw_walls(cairo_t* cairo, const GridMap& map, const Placed& at) {
  std::vector<std::array<Pixel, 2>> lines;
  for (const auto& [from, to] : map.walls) lines.push_back({pixel_of(map, at, from), pixel_of(map, at, to)});
  draw_walls(cairo, {{at.x, at.y}, map.width * at.scale, map.height * at.scale}, lines);
}

// Level grids are shown with north above.
bool is_seen_from_above(const GridMap& map, const MapOptions& options) {
  return (map.above - options.north).norm() < 1e-9;
}

std::string digits(double value) {
  const int decimals = value >= 100 ? 0 : value >= 10 ? 1 : 2;
  std::string text = std::to_string(std::round(value * std::pow(10, decimals)) / std::pow(10, decimals));
  const std::size_t point = text.find('.');
  return text.substr(0, decimals == 0 ? point : point + 1 + static_cast<std::size_t>(decimals));
}

std::string told(const GridMap& map, const std::string& unit) {
  double least = std::numeric_limits<double>::infinity(), sum = 0;
  int count = 0;
  for (const double value : map.values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    sum += value;
    ++count;
  }
  if (count == 0) return "all inside walls";
  const double mean = sum / count;
  return "mean " + digits(mean) + " " + unit + ", least " + digits(least) + " " + unit + ", U0 " +
         (mean > 0 ? digits(least / mean) : "-");
}

// Common to all maps of a file.
struct MapStyle {
  AxisRange range;
  std::vector<Tick> levels;
  std::string unit;
  double width;  // of the place of each, pixels
  const MapOptions& options;
};

void draw_map(cairo_t* cairo, const GridMap& map, const Placed& at, const MapStyle& style) {
  draw_cells(cairo, map, at, style.range);
  draw_walls(cairo, map, at);
  draw_isolines(cairo, map, at, style.levels);
  set_grey(cairo, ink);
  const bool has_arrow = style.options.north_known && is_seen_from_above(map, style.options);
  const double of_arrow = std::max(map.width * at.scale, style.width / 2);
  const double of_name = has_arrow ? of_arrow - 24 : style.width;  // room of the arrow with its N
  draw_text(cairo, {at.x, at.y - line_height / 2}, fitting_text(cairo, map.group->name, of_name), Align::left);
  draw_text(cairo, {at.x, at.y + map.height * at.scale + line_height / 2}, told(map, style.unit), Align::left);
  if (has_arrow) draw_north(cairo, {at.x + of_arrow, at.y - line_height / 2});
}

// Maps all to one scale, two beside each other.
struct Layout {
  double scale = 1;  // pixels for each meter
  double wide = 0, high = 0;
  std::size_t columns = 1, rows = 1;
};

Layout layout_of(std::span<const GridMap> maps) {
  double widest = 0, highest = 0;
  for (const GridMap& map : maps) {
    widest = std::max(widest, map.width);
    highest = std::max(highest, map.height);
  }
  const double scale = std::min(520 / widest, highest_map / highest);
  const std::size_t columns = std::min<std::size_t>(2, maps.size());
  return {scale, std::max(widest * scale, 300.0) + map_edge, highest * scale + 2 * line_height + map_edge, columns,
          (maps.size() + columns - 1) / columns};
}

std::string title_of(MapQuantity quantity, const Readings& readings, const std::string& unit) {
  if (quantity == MapQuantity::daylight_factor) return "daylight factor, " + unit;
  return (readings.photometric ? "illuminance, " : "irradiance, ") + unit;
}

}  // namespace

std::vector<IsolinePiece> isoline(const Eigen::MatrixXd& values, double level) {
  std::vector<IsolinePiece> pieces;
  for (Eigen::Index row = 0; row + 1 < values.rows(); ++row) {
    for (Eigen::Index column = 0; column + 1 < values.cols(); ++column) {
      const std::array<double, 4> around = {values(row, column), values(row, column + 1), values(row + 1, column + 1),
                                            values(row + 1, column)};
      const double mean = (around[0] + around[1] + around[2] + around[3]) / 4;
      if (!(mean == mean)) continue;
      const auto found = crossings(around, static_cast<double>(column), static_cast<double>(row), level);
      // At a saddle with four crossings, the mean decides how they are connected.
      const std::size_t shift = found.size() == 4 && (mean >= level) == (around[0] >= level) ? 0 : 1;
      if (found.size() == 2) pieces.push_back({found[0], found[1]});
      for (std::size_t k = 0; found.size() == 4 && k < 4; k += 2)
        pieces.push_back({found[(k + shift) % 4], found[(k + shift + 1) % 4]});
    }
  }
  return pieces;
}

void write_sensor_map(const std::filesystem::path& file, std::span<const SensorGroup> groups, const Readings& readings,
                      const MapOptions& options) {
  const bool is_factor = options.quantity == MapQuantity::daylight_factor;
  if (is_factor && !readings.outside_by_sky)
    throw OutputError(file.string(),
                      "there are no daylight factors, which are of a CIE overcast sky as the only light");
  const std::vector<GridMap> maps = grid_maps(groups, readings, options);
  if (maps.empty()) throw OutputError(file.string(), "a map needs a grid of sensors, and there are only single points");
  const AxisRange range = range_of(maps, options);
  const std::string unit = is_factor ? "%" : sensor_unit(readings);
  const Layout layout = layout_of(maps);
  const MapStyle style{range, axis_ticks(range, Scale::linear, most_levels), unit, layout.wide - map_edge, options};
  const double legend = map_edge + static_cast<double>(layout.columns) * layout.wide;
  const int width = static_cast<int>(std::ceil(legend + 150 + map_edge));
  const int height = static_cast<int>(
      std::ceil(std::max(map_edge + static_cast<double>(layout.rows) * layout.high, highest_map + 3 * map_edge)));
  write_drawing(file, width, height, [&](cairo_t* cairo) {
    set_grey(cairo, 1);
    cairo_paint(cairo);
    set_text_size(cairo, map_text);
    for (std::size_t k = 0; k < maps.size(); ++k) {
      const std::size_t row = k / layout.columns;
      const Placed at{map_edge + static_cast<double>(k % layout.columns) * layout.wide,
                      map_edge + line_height + static_cast<double>(row) * layout.high, layout.scale};
      draw_map(cairo, maps[k], at, style);
    }
    set_grey(cairo, ink);
    draw_text(cairo, {legend, map_edge + line_height / 2}, title_of(options.quantity, readings, unit), Align::left);
    const double top = map_edge + 2 * line_height;
    draw_colours(cairo, {{legend, top}, 22, highest_map - 2 * line_height}, range, style.levels);
    draw_scale_bar(cairo, {legend, map_edge + highest_map + line_height}, layout.scale, 100);
  });
}

}  // namespace patchlight
