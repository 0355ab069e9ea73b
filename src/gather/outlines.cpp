#include "gather/outlines.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - along * (b - a)).norm();
}

// Winding number of the outline around the point by the angles under which its edges are seen; seams cancel.
bool is_over(const Point& point, const Outline& outline) {
  double angle = 0;
  for (std::size_t k = 0; k < outline.corners.size(); ++k) {
    const Vector a = outline.corners[k] - point;
    const Vector b = outline.corners[(k + 1) % outline.corners.size()] - point;
    angle += std::atan2(a.cross(b).dot(outline.normal), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

}  // namespace

std::vector<Outline> outlines_of(const Scene& scene) {
  std::vector<Outline> outlines;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    Outline outline{corner_points(scene, p), front_normal(scene, p)};
    Box box;
    for (const Point& corner : outline.corners) box.extend(corner);
    outline.size = box.diagonal().norm();
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

bool lies_on(const Point& point, const Outline& outline, double tolerance) {
  if (std::abs(outline.height(point)) > tolerance) return false;
  if (is_over(point, outline)) return true;
  for (std::size_t k = 0; k < outline.corners.size(); ++k) {
    const Point& next = outline.corners[(k + 1) % outline.corners.size()];
    if (distance_to_segment(point, outline.corners[k], next) <= tolerance) return true;
  }
  return false;
}

}  // namespace patchlight
