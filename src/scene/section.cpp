#include "scene/section.h"

#include <algorithm>
#include <cstddef>

namespace patchlight {
namespace {

// Where the outline crosses the plane: a corner in the plane counts as above it.
std::vector<Point> crossings(const std::vector<Point>& corners, const Point& on, const Vector& normal) {
  std::vector<Point> found;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point &a = corners[k], &b = corners[(k + 1) % corners.size()];
    const double from = (a - on).dot(normal), to = (b - on).dot(normal);
    if ((from < 0) != (to < 0)) found.push_back(a + from / (from - to) * (b - a));
  }
  return found;
}

}  // namespace

std::vector<std::array<Point, 2>> section_of(const Scene& scene, const Point& on, const Vector& normal) {
  std::vector<std::array<Point, 2>> pieces;
  constexpr double parallel = 1e-6;  // sine of the angle: what lies in the plane has no line there but rounding
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    // Along the line every second piece is within the polygon. Seams cross twice at one place, with nothing between.
    const Vector along = front_normal(scene, p).cross(normal);
    if (along.norm() < parallel * normal.norm()) continue;
    std::vector<Point> found = crossings(corner_points(scene, p), on, normal);
    std::sort(found.begin(), found.end(), [&](const Point& a, const Point& b) { return a.dot(along) < b.dot(along); });
    for (std::size_t k = 0; k + 1 < found.size(); k += 2) pieces.push_back({found[k], found[k + 1]});
  }
  return pieces;
}

}  // namespace patchlight
