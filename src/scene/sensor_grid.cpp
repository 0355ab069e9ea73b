#include "scene/sensor_grid.h"

#include "scene/extent.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace patchlight {
namespace {

// The longest edge of the polygons, made level and of unit length.
Vector longest_edge(const Scene& scene, std::span<const PolygonIndex> floor) {
  Vector longest = Vector::Zero();
  for (const PolygonIndex p : floor) {
    const std::vector<Point> points = corner_points(scene, p);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vector edge = points[(k + 1) % points.size()] - points[k];
      // The first of edges that are equal up to rounding, so that a square room is not turned by it.
      if (edge.squaredNorm() > (1 + 1e-9) * longest.squaredNorm()) longest = edge;
    }
  }
  return (longest - longest.dot(scene.up) * scene.up).normalized();
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

double cells_along(double length, double spacing) { return std::max(1.0, std::ceil(length / spacing - 1e-9)); }

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

std::vector<PolygonIndex> floor_of(const Scene& scene, std::span<const PolygonIndex> polygons) {
  constexpr double level_cosine = 1 - 1e-6;  // 0.08 degrees
  constexpr double one_height = 1e-4;        // of the scene's extent
  double lowest = std::numeric_limits<double>::infinity();
  std::vector<std::pair<PolygonIndex, double>> level;
  for (const PolygonIndex p : polygons) {
    if (std::abs(front_normal(scene, p).dot(scene.up)) < level_cosine) continue;
    level.emplace_back(p, corner_points(scene, p)[0].dot(scene.up));
    lowest = std::min(lowest, level.back().second);
  }
  std::vector<PolygonIndex> floor;
  const double tolerance = one_height * extent_of(scene);
  for (const auto& [p, height] : level) {
    if (height <= lowest + tolerance) floor.push_back(p);
  }
  return floor;
}

std::array<Vector, 3> rectangle_over(const Scene& scene, std::span<const PolygonIndex> floor, double height) {
  const Vector x = longest_edge(scene, floor);
  const Vector y = scene.up.cross(x);
  Box box;  // in the coordinates (x, y, up)
  for (const PolygonIndex p : floor) {
    for (const Point& point : corner_points(scene, p)) {
      box.extend(Point(point.dot(x), point.dot(y), point.dot(scene.up)));
    }
  }
  const Point low = box.min().x() * x + box.min().y() * y + (box.min().z() + height) * scene.up;
  return {low, box.sizes().x() * x, box.sizes().y() * y};
}

SensorGroup floor_grid(const Scene& scene, std::span<const PolygonIndex> floor, double height, double spacing) {
  assert(!floor.empty());
  const std::array<Vector, 3> around = rectangle_over(scene, floor, height);
  const SensorGroup all = rectangle_grid(around[0], {around[1], around[2]}, spacing);
  std::vector<std::vector<Point>> outlines;
  for (const PolygonIndex p : floor) outlines.push_back(corner_points(scene, p));
  SensorGroup group;
  for (std::size_t k = 0; k < all.sensors.size(); ++k) {
    const bool over_floor = std::any_of(outlines.begin(), outlines.end(), [&](const std::vector<Point>& outline) {
      return is_inside(outline, all.sensors[k].point, around[1], around[2]);
    });
    if (!over_floor) continue;
    group.sensors.push_back(all.sensors[k]);
    group.cells.push_back(all.cells[k]);
  }
  return group;
}

}  // namespace patchlight
