#include "verify/sensor_point.h"

#include "base/parallel.h"
#include "scene/extent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

constexpr double share_of_polygon = 1e-5;
constexpr double share_of_scene = 1e-6;

// A sensor on a polygon is read at this share of the scene's extent before it: the ray caster resolves half of that.
constexpr double height_share = 2e-9;

// A polygon, and the distance within which a sensor lies on it.
struct Surround {
  std::vector<Point> corners;
  Vector normal;
  Box box;
  double tolerance = 0;

  bool touches(const Point& point) const;
};

double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - along * (b - a)).norm();
}

// Inside the outline, by the winding number of its edges around the point, or near an edge. The two ways along a seam
// cancel.
bool Surround::touches(const Point& point) const {
  if (box.squaredExteriorDistance(point) > tolerance * tolerance) return false;
  if (std::abs(normal.dot(point - corners[0])) > tolerance) return false;
  double angle = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point& next = corners[(k + 1) % corners.size()];
    if (distance_to_segment(point, corners[k], next) <= tolerance) return true;
    const Vector a = corners[k] - point;
    const Vector b = next - point;
    angle += std::atan2(a.cross(b).dot(normal), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

}  // namespace

std::vector<Point> points_before_polygons(const Scene& scene, std::span<const Sensor> sensors) {
  const double extent = extent_of(scene);
  std::vector<Surround> polygons;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    Surround polygon{corner_points(scene, p), front_normal(scene, p), {}, 0};
    for (const Point& corner : polygon.corners) polygon.box.extend(corner);
    polygon.tolerance = std::max(share_of_polygon * polygon.box.diagonal().norm(), share_of_scene * extent);
    polygons.push_back(std::move(polygon));
  }
  std::vector<Point> points(sensors.size());
  parallel_for(points.size(), [&](std::size_t k) {
    points[k] = sensors[k].point;
    for (const Surround& polygon : polygons) {
      if (!polygon.touches(points[k])) continue;
      const double facing = polygon.normal.dot(sensors[k].normal) < 0 ? -1 : 1;
      points[k] +=
          (facing * height_share * extent - polygon.normal.dot(points[k] - polygon.corners[0])) * polygon.normal;
    }
  });
  return points;
}

}  // namespace patchlight
