#include "mesh/outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {

bool comes_before(const Point& a, const Point& b) {
  if (a.x() != b.x()) return a.x() < b.x();
  if (a.y() != b.y()) return a.y() < b.y();
  return a.z() < b.z();
}

std::uint32_t parts_of(const Point& from, const Point& to, double max_edge) {
  // An edge of n max_edge has n parts, whatever the rounding of its length.
  constexpr double rounding = 1e-9;
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil((to - from).norm() / max_edge - rounding)));
}

Outline make_outline(std::vector<Point> corners, const Vector& normal, double max_edge) {
  Outline outline{.corners = std::move(corners), .parts = {}, .normal = normal};
  const std::size_t n = outline.corners.size();
  outline.parts.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    outline.parts.push_back(parts_of(outline.corners[k], outline.corners[(k + 1) % n], max_edge));
  }
  return outline;
}

Point edge_point(const Point& from, const Point& to, std::uint32_t index, std::uint32_t parts) {
  if (index == 0) return from;
  if (index == parts) return to;
  if (comes_before(to, from)) return edge_point(to, from, parts - index, parts);
  return from + static_cast<double>(index) / parts * (to - from);
}

std::vector<Point> boundary_points(const Outline& outline) {
  std::vector<Point> points;
  const std::size_t n = outline.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::uint32_t i = 0; i < outline.parts[k]; ++i) {
      points.push_back(edge_point(outline.corners[k], outline.corners[(k + 1) % n], i, outline.parts[k]));
    }
  }
  return points;
}

}  // namespace patchlight
