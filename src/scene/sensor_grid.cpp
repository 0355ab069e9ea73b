#include "scene/sensor_grid.h"

#include "base/tolerances.h"
#include "scene/room_body.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>

namespace patchlight {
namespace {

// An edge without direction, in steps of a millimeter, so that polygons that share it find each other.
using EdgeKey = std::array<std::array<std::int64_t, 3>, 2>;

EdgeKey edge_key(const Point& a, const Point& b) {
  const auto in_steps = [](const Point& p) {
    return std::array<std::int64_t, 3>{std::llround(1000 * p.x()), std::llround(1000 * p.y()),
                                       std::llround(1000 * p.z())};
  };
  EdgeKey key = {in_steps(a), in_steps(b)};
  if (key[1] < key[0]) std::swap(key[0], key[1]);
  return key;
}

using Edge = std::array<Point, 2>;

// Edges that one outline has, not two: no inner diagonals, and no seams.
std::vector<Edge> rim_of(const Floor& floor) {
  std::map<EdgeKey, std::pair<int, Edge>> edges;
  for (const std::vector<Point>& outline : floor.outlines) {
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const Edge edge = {outline[k], outline[(k + 1) % outline.size()]};
      const EdgeKey key = edge_key(edge[0], edge[1]);
      if (key[0] != key[1]) ++edges.try_emplace(key, 0, edge).first->second.first;
    }
  }
  std::vector<Edge> rim;
  for (const auto& [key, found] : edges) {
    if (found.first == 1) rim.push_back(found.second);
  }
  return rim;
}

// The level unit direction along or across which most of the rim runs, of those of its longest edges.
Vector main_direction(const std::vector<Edge>& rim, const Vector& up) {
  constexpr double along = 0.9998;  // cosine of 1 degree
  std::vector<Vector> edges;
  for (const Edge& edge : rim) {
    const Vector way = edge[1] - edge[0];
    edges.push_back(way - way.dot(up) * up);
  }
  // Lengths that are equal up to tolerance_of_coordinates keep the order of the rim, so that a square room is not
  // turned by it.
  const auto rounded_length = [](const Vector& edge) { return std::llround(1e6 * edge.norm()); };
  std::stable_sort(edges.begin(), edges.end(),
                   [&](const Vector& a, const Vector& b) { return rounded_length(a) > rounded_length(b); });
  Vector best = up.unitOrthogonal();
  double longest = 0;
  for (std::size_t k = 0; k < std::min<std::size_t>(edges.size(), 200) && edges[k].norm() > 0; ++k) {
    const Vector x = edges[k].normalized();
    double length = 0;
    for (const Vector& edge : edges) {
      const double own = edge.norm();
      const double cosine = std::abs(edge.dot(x));
      if (cosine > along * own || cosine < std::sqrt(1 - along * along) * own) length += own;
    }
    if (length > (1 + tolerance_of_shapes) * longest) {
      longest = length;
      best = x;
    }
  }
  return best;
}

// Does a ray from the point along x, in the plane of x and y, cross the outline an odd number of times? The two ways of
// a seam to a hole cancel.
bool is_inside(const std::vector<Point>& outline, const Point& point, const Vector& x, const Vector& y) {
  bool inside = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector a = outline[k] - point;
    const Vector b = outline[(k + 1) % outline.size()] - point;
    if ((a.dot(y) > 0) == (b.dot(y) > 0)) continue;
    const double share = a.dot(y) / (a.dot(y) - b.dot(y));
    inside ^= a.dot(x) + share * (b - a).dot(x) > 0;
  }
  return inside;
}

double distance_from(const std::vector<Edge>& rim, const Point& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Edge& edge : rim) nearest = std::min(nearest, std::sqrt(squared_distance(point, edge[0], edge[1])));
  return nearest;
}

// Is a point in the plane of the floor, which has these two directions, on it?
bool is_over(const Floor& floor, const Point& point, const std::array<Vector, 2>& plane) {
  return std::any_of(floor.outlines.begin(), floor.outlines.end(),
                     [&](const std::vector<Point>& outline) { return is_inside(outline, point, plane[0], plane[1]); });
}

// The distance from the rim of the place of a floor that is farthest from it, of 51 x 51 places; or of the first that
// is as far from it as is enough.
double farthest_from_rim(const Floor& floor, const std::array<Vector, 3>& around, double enough) {
  constexpr int places = 51;  // each way, with one in the middle
  const std::vector<Edge> rim = rim_of(floor);
  double farthest = 0;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      const Point at = around[0] + (column + 0.5) / places * around[1] + (row + 0.5) / places * around[2];
      if (is_over(floor, at, {around[1], around[2]})) farthest = std::max(farthest, distance_from(rim, at));
      if (farthest >= enough) return farthest;
    }
  }
  return farthest;
}

bool is_level(const std::vector<Point>& face, const Vector& up) {
  const Vector area = area_vector(face);
  return area.norm() > 0 && std::abs(area.normalized().dot(up)) >= 1 - 1e-6;  // within 0.08 degrees
}

using Levels = std::map<double, Floor>;  // by their height, from below

Levels levels_of(const std::vector<std::vector<Point>>& faces, const Vector& up) {
  constexpr double one_height = 1e-3;  // meters
  Levels levels;
  for (const std::vector<Point>& face : faces) {
    if (!is_level(face, up)) continue;
    const double height = face[0].dot(up);
    auto level = levels.lower_bound(height - one_height);
    if (level == levels.end() || level->first > height + one_height)
      level = levels.emplace(height, Floor{{}, up}).first;
    level->second.outlines.push_back(face);
  }
  return levels;
}

}  // namespace

double cells_along(double length, double spacing) {
  return std::max(1.0, std::ceil(length / spacing - tolerance_of_coordinates));
}

SensorGroup rectangle_grid(const Point& corner, const std::array<Vector, 2>& edges, double spacing) {
  const double across = cells_along(edges[0].norm(), spacing);
  const double along = cells_along(edges[1].norm(), spacing);
  assert(across * along <= most_sensors);
  SensorGroup group;
  const Vector normal = edges[0].cross(edges[1]).normalized();
  const auto at = [&](double u, double v) -> Point { return corner + u / across * edges[0] + v / along * edges[1]; };
  for (double v = 0; v < along; ++v) {
    for (double u = 0; u < across; ++u) {
      group.sensors.push_back({at(u + 0.5, v + 0.5), normal});
      group.cells.push_back({at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)});
    }
  }
  return group;
}

Floor floor_of(const std::vector<std::vector<Point>>& faces, const Vector& up) {
  const Levels levels = levels_of(faces, up);
  if (levels.empty()) return {{}, up};
  const auto lowest = levels.begin();
  for (auto above = std::next(lowest); above != levels.end(); ++above) {
    // A slab is at most 0.6 m thick, and its top as large as its underside, but for a twentieth.
    if (above->first - lowest->first > 0.6) break;
    if (area_of(above->second) >= 0.95 * area_of(lowest->second)) return above->second;
  }
  return lowest->second;
}

Floor floor_of_room(const std::vector<std::vector<Point>>& faces, const Vector& up) {
  const RoomBody body(faces);
  std::vector<std::vector<Point>> under_air;
  for (const std::vector<Point>& face : faces) {
    if (!is_level(face, up)) continue;
    if (body.holds(inner_point(face) + body.step() * up)) under_air.push_back(face);
  }
  const Levels levels = levels_of(under_air, up);
  const auto largest = std::max_element(levels.begin(), levels.end(), [](const auto& a, const auto& b) {
    return area_of(a.second) < (1 - tolerance_of_coordinates) * area_of(b.second);
  });
  return largest == levels.end() ? floor_of(faces, up) : largest->second;
}

std::vector<std::vector<Point>> outlines_of(const Scene& scene, std::span<const PolygonIndex> polygons) {
  std::vector<std::vector<Point>> outlines;
  for (const PolygonIndex p : polygons) outlines.push_back(corner_points(scene, p));
  return outlines;
}

double area_of(const Floor& floor) {
  double area = 0;
  for (const std::vector<Point>& outline : floor.outlines) area += area_vector(outline).norm();
  return area;
}

std::array<Vector, 3> rectangle_over(const Floor& floor, double height) {
  const Vector x = main_direction(rim_of(floor), floor.up);
  const Vector y = floor.up.cross(x);
  Box box;  // in the coordinates (x, y, up)
  for (const std::vector<Point>& outline : floor.outlines) {
    for (const Point& point : outline) box.extend(Point(point.dot(x), point.dot(y), point.dot(floor.up)));
  }
  const Point low = box.min().x() * x + box.min().y() * y + (box.min().z() + height) * floor.up;
  return {low, box.sizes().x() * x, box.sizes().y() * y};
}

double standard_spacing(double side, double other_side) {
  const auto [shorter, longer] = std::minmax(side, other_side);
  const double d = longer >= 2 * shorter ? shorter : longer;
  return std::min(10.0, 0.2 * std::pow(5, std::log10(d)));  // EN 12464-1:2021, equation (2)
}

GridSize standard_grid(const Floor& floor) {
  constexpr double strip = 0.5;
  const std::array<Vector, 3> around = rectangle_over(floor, 0);
  const double spacing = standard_spacing(around[1].norm(), around[2].norm());
  // In the widest place r from the rim the strip takes r / 2 at most, and cells as wide as the rest of both sides fit.
  const double widest = farthest_from_rim(floor, around, strip + std::max(strip, spacing / 2));
  // A floor so thin that none of the places is on it has no strip.
  if (!(widest > 0)) return {spacing, 0};
  const double from_walls = std::min(strip, widest / 2);
  // Not so small that a narrow floor gets very many cells.
  return {std::max(spacing / 100, std::min(spacing, 2 * (widest - from_walls))), from_walls};
}

double most_cells(const Floor& floor, const GridSize& size) {
  const auto [corner, x, y] = rectangle_over(floor, 0);
  const auto cells = [&](const Vector& side) {
    return cells_along(std::max(0.0, side.norm() - 2 * size.from_walls), size.spacing);
  };
  return cells(x) * cells(y);
}

SensorGroup floor_grid(const Floor& floor, double height, const GridSize& size) {
  assert(!floor.outlines.empty());
  const auto [corner, x, y] = rectangle_over(floor, height);
  const Vector strip_x = size.from_walls * x.normalized(), strip_y = size.from_walls * y.normalized();
  const Vector inner_x = x - 2 * strip_x, inner_y = y - 2 * strip_y;
  if (!(inner_x.dot(x) > 0) || !(inner_y.dot(y) > 0)) return {};
  const SensorGroup all = rectangle_grid(corner + strip_x + strip_y, {inner_x, inner_y}, size.spacing);
  const std::vector<Edge> rim = rim_of(floor);
  SensorGroup group;
  for (std::size_t k = 0; k < all.sensors.size(); ++k) {
    const Point on_floor = all.sensors[k].point - height * floor.up;
    const bool is_free =
        is_over(floor, on_floor, {x, y}) &&
        (size.from_walls == 0 || distance_from(rim, on_floor) >= (1 - tolerance_of_coordinates) * size.from_walls);
    if (!is_free) continue;
    group.sensors.push_back(all.sensors[k]);
    group.cells.push_back(all.cells[k]);
  }
  return group;
}

double area_of(const SensorGroup& grid) {
  double area = 0;
  for (const auto& cell : grid.cells) area += area_vector(cell).norm();
  return area;
}

}  // namespace patchlight
