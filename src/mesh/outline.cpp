#include "mesh/outline.h"

#include "scene/triangulate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
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

bool is_quad_grid(const Outline& outline) {
  const auto& parts = outline.parts;
  return outline.lines.empty() && parts.size() == 4 && parts[0] == parts[2] && parts[1] == parts[3] &&
         is_convex(outline.corners);
}

Grading grading_of_edge(const Outline& outline, std::size_t edge) {
  if (outline.is_graded.empty()) return {};
  assert(outline.is_graded.size() == 4);
  return {outline.is_graded[(edge + 3) % 4] != 0, outline.is_graded[(edge + 1) % 4] != 0};
}

double share_of_edge(std::uint32_t index, std::uint32_t parts, Grading grading) {
  // From the nearer end, so that both halves have the same parts.
  if (grading.at_from && grading.at_to && 2 * index > parts) return 1 - share_of_edge(parts - index, parts, grading);
  const double t = static_cast<double>(index) / parts;
  if (grading.at_from && grading.at_to) return (1 - std::cos(std::numbers::pi * t)) / 2;
  if (grading.at_from) return 1 - std::cos(std::numbers::pi / 2 * t);
  if (grading.at_to) return std::sin(std::numbers::pi / 2 * t);
  return t;
}

Point edge_point(const Point& from, const Point& to, std::uint32_t index, std::uint32_t parts, Grading grading) {
  if (index == 0) return from;
  if (index == parts) return to;
  if (comes_before(to, from)) return edge_point(to, from, parts - index, parts, {grading.at_to, grading.at_from});
  return from + share_of_edge(index, parts, grading) * (to - from);
}

std::vector<Point> boundary_points(const Outline& outline) {
  std::vector<Point> points;
  const std::size_t n = outline.corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::uint32_t i = 0; i < outline.parts[k]; ++i) {
      points.push_back(edge_point(outline.corners[k], outline.corners[(k + 1) % n], i, outline.parts[k],
                                  grading_of_edge(outline, k)));
    }
  }
  return points;
}

}  // namespace patchlight
