#include "gather/facets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - along * (b - a)).norm();
}

// Winding number of the facet around the point by the angles under which its edges are seen; seams cancel.
bool is_over(const Point& point, const Facet& facet) {
  double angle = 0;
  for (std::size_t k = 0; k < facet.corners.size(); ++k) {
    const Vector a = facet.corners[k] - point;
    const Vector b = facet.corners[(k + 1) % facet.corners.size()] - point;
    angle += std::atan2(a.cross(b).dot(facet.normal), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

}  // namespace

std::vector<Facet> facets_of(const Scene& scene) {
  std::vector<Facet> facets;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    Facet facet{corner_points(scene, p), front_normal(scene, p)};
    Box box;
    for (const Point& corner : facet.corners) box.extend(corner);
    facet.size = box.diagonal().norm();
    facets.push_back(std::move(facet));
  }
  return facets;
}

bool lies_on(const Point& point, const Facet& facet, double tolerance) {
  if (std::abs(facet.height(point)) > tolerance) return false;
  if (is_over(point, facet)) return true;
  for (std::size_t k = 0; k < facet.corners.size(); ++k) {
    const Point& next = facet.corners[(k + 1) % facet.corners.size()];
    if (distance_to_segment(point, facet.corners[k], next) <= tolerance) return true;
  }
  return false;
}

}  // namespace patchlight
