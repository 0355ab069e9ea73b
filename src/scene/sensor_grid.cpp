#include "scene/sensor_grid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>

namespace patchlight {
namespace {

// Cosine of 0.08 degrees.
constexpr double level_cosine = 1 - 1e-6;

// An edge without direction, in steps of a millimetre, so that polygons that share it find each other.
using EdgeKey = std::array<std::array<std::int64_t, 3>, 2>;

EdgeKey edge_key(const Point& a, const Point& b) {
  const auto in_steps = [](const Point& p) {
    constexpr double steps = 1000;  // per metre
    return std::array{std::llround(steps * p.x()), std::llround(steps * p.y()), std::llround(steps * p.z())};
  };
  const auto first = in_steps(a), second = in_steps(b);
  EdgeKey key;
  std::copy(first.begin(), first.end(), key[0].begin());
  std::copy(second.begin(), second.end(), key[1].begin());
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
  constexpr std::size_t most_candidates = 200;
  constexpr double along = 0.9998;  // cosine of 1 degree
  std::vector<Vector> edges;
  for (const Edge& edge : rim) {
    const Vector way = edge[1] - edge[0];
    edges.push_back(way - way.dot(up) * up);
  }
  // Lengths that are equal up to rounding keep the order of the rim, so that a square room is not turned by it.
  const auto rounded_length = [](const Vector& edge) { return std::llround(1e6 * edge.norm()); };
  std::stable_sort(edges.begin(), edges.end(),
                   [&](const Vector& a, const Vector& b) { return rounded_length(a) > rounded_length(b); });
  Vector best = up.unitOrthogonal();
  double longest = 0;
  for (std::size_t k = 0; k < std::min(edges.size(), most_candidates) && edges[k].norm() > 0; ++k) {
    const Vector x = edges[k].normalized();
    double length = 0;
    for (const Vector& edge : edges) {
      const double own = edge.norm();
      const double cosine = std::abs(edge.dot(x));
      if (cosine > along * own || cosine < std::sqrt(1 - along * along) * own) length += own;
    }
    if (length > (1 + 1e-9) * longest) {
      longest = length;
      best = x;
    }
  }
  return best;
}

double distance_from(const Edge& edge, const Point& point) {
  const Vector way = edge[1] - edge[0];
  const double along = std::clamp((point - edge[0]).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (edge[0] + along * way - point).norm();
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

}  // namespace

double cells_along(double length, double spacing) {
  constexpr double rounding = 1e-6;  // coordinates of some formats have single precision
  return std::max(1.0, std::ceil(length / spacing - rounding));
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
  constexpr double one_height = 1e-3;    // metres
  constexpr double thickest_slab = 0.6;  // metres
  constexpr double same_area = 0.95;     // of the underside is over it
  std::map<double, Floor> levels;        // by their height, from below
  for (const std::vector<Point>& face : faces) {
    const Vector area = area_vector(face);
    if (!(area.norm() > 0) || std::abs(area.normalized().dot(up)) < level_cosine) continue;
    const double height = face[0].dot(up);
    auto level = levels.lower_bound(height - one_height);
    if (level == levels.end() || level->first > height + one_height)
      level = levels.emplace(height, Floor{{}, up}).first;
    level->second.outlines.push_back(face);
  }
  if (levels.empty()) return {{}, up};
  const auto lowest = levels.begin();
  for (auto above = std::next(lowest); above != levels.end(); ++above) {
    if (above->first - lowest->first > thickest_slab) break;
    if (area_of(above->second) >= same_area * area_of(lowest->second)) return above->second;
  }
  return lowest->second;
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

SensorGroup floor_grid(const Floor& floor, double height, double spacing, double from_walls) {
  assert(!floor.outlines.empty());
  const std::array<Vector, 3> around = rectangle_over(floor, height);
  const SensorGroup all = rectangle_grid(around[0], {around[1], around[2]}, spacing);
  const std::vector<Edge> rim = rim_of(floor);
  const auto is_clear_of_walls = [&](const Point& at) {
    const Point on_floor = at - height * floor.up;
    return std::all_of(rim.begin(), rim.end(),
                       [&](const Edge& edge) { return distance_from(edge, on_floor) >= from_walls; });
  };
  SensorGroup group;
  for (std::size_t k = 0; k < all.sensors.size(); ++k) {
    const Point& at = all.sensors[k].point;
    const bool over_floor =
        std::any_of(floor.outlines.begin(), floor.outlines.end(),
                    [&](const std::vector<Point>& outline) { return is_inside(outline, at, around[1], around[2]); });
    if (!over_floor || (from_walls > 0 && !is_clear_of_walls(at))) continue;
    group.sensors.push_back(all.sensors[k]);
    group.cells.push_back(all.cells[k]);
  }
  return group;
}

}  // namespace patchlight
