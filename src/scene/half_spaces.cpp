#include "scene/half_spaces.h"

#include "scene/extent.h"

#include <algorithm>

namespace patchlight {
namespace {

constexpr double plane_tolerance = 1e-6;  // of the scene's extent

std::vector<Point> used_vertices(const Scene& scene) {
  std::vector<std::uint8_t> used(scene.vertices.size(), 0);
  for (const Polygon& polygon : scene.polygons) {
    for (const std::uint32_t corner : polygon.corners) used[corner] = 1;
  }
  std::vector<Point> points;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v]) points.push_back(scene.vertices[v]);
  }
  return points;
}

// Moves the extreme vertices of 13 axes to the front: most polygons are found to lie inside after these.
std::vector<Point> extremes_first(std::vector<Point> points) {
  std::size_t front = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const Vector axis(x, y, z);
        const auto farthest = std::max_element(
            points.begin(), points.end(), [&](const Point& a, const Point& b) { return a.dot(axis) < b.dot(axis); });
        if (front < points.size()) std::swap(points[front++], *farthest);
      }
    }
  }
  return points;
}

}  // namespace

HalfSpaces occupied_half_spaces(const Scene& scene) {
  const std::vector<Point> points = extremes_first(used_vertices(scene));
  const double tolerance = plane_tolerance * extent_of(scene);
  HalfSpaces occupied{std::vector<std::uint8_t>(scene.polygons.size(), 0),
                      std::vector<std::uint8_t>(scene.polygons.size(), 0)};
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const Vector normal = front_normal(scene, p);
    const Point& on_plane = scene.vertices[scene.polygons[p].corners[0]];
    bool before = false;
    bool behind = false;
    for (const Point& point : points) {
      const double height = normal.dot(point - on_plane);
      before = before || height > tolerance;
      behind = behind || height < -tolerance;
      if (before && behind) break;
    }
    occupied.before[p] = before;
    occupied.behind[p] = behind;
  }
  return occupied;
}

}  // namespace patchlight
