#include "patchlight/base/geometry.h"

#include <cmath>

namespace patchlight {
namespace {

// A point that is lower over a plane than this share of its distance from a point on it lies on the plane.
constexpr double on_plane_tolerance = 1e-9;

}  // namespace

Vector area_vector(std::span<const Point> polygon) {
  // 1/2 sum_k (p_k - p_0) x (p_k+1 - p_0); taken about p_0 so that nothing cancels far from the origin.
  Vector sum = Vector::Zero();
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    sum += (polygon[k] - polygon[0]).cross(polygon[k + 1] - polygon[0]);
  }
  return 0.5 * sum;
}

Point area_centroid(std::span<const Point> polygon) {
  const Vector normal = area_vector(polygon);
  const double area_squared = normal.squaredNorm();
  Vector offset = Vector::Zero();
  if (area_squared > 0) {
    // Mean of the fan triangles' centroids, weighted by their signed areas.
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
      const Vector a = polygon[k] - polygon[0];
      const Vector b = polygon[k + 1] - polygon[0];
      const double weight = 0.5 * a.cross(b).dot(normal) / area_squared;
      offset += weight * (a + b) / 3.0;
    }
  } else {
    for (const Point& corner : polygon) offset += (corner - polygon[0]) / static_cast<double>(polygon.size());
  }
  return polygon[0] + offset;
}

std::vector<Point> clip_to_half_space(std::span<const Point> polygon, const Point& on_plane, const Vector& normal) {
  // Corners on the plane are kept whichever way rounding moves them, so that a turned scene gives the same polygon.
  const double length = normal.norm();
  const auto height = [&](const Point& corner) {
    const Vector offset = corner - on_plane;
    const double along = normal.dot(offset);
    return std::abs(along) <= on_plane_tolerance * length * offset.norm() ? 0 : along;
  };
  // Sutherland and Hodgman 1974, one plane.
  std::vector<Point> kept;
  kept.reserve(polygon.size() + 1);
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point& here = polygon[k];
    const Point& next = polygon[(k + 1) % polygon.size()];
    const double height_here = height(here);
    const double height_next = height(next);
    if (height_here >= 0) kept.push_back(here);
    if ((height_here > 0 && height_next < 0) || (height_here < 0 && height_next > 0)) {
      kept.push_back(here + height_here / (height_here - height_next) * (next - here));
    }
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

double signed_solid_angle(const Point& eye, const Point& a, const Point& b, const Point& c) {
  const Vector r1 = a - eye;
  const Vector r2 = b - eye;
  const Vector r3 = c - eye;
  const double l1 = r1.norm();
  const double l2 = r2.norm();
  const double l3 = r3.norm();
  // tan(omega / 2) = r1 . (r2 x r3) / (l1 l2 l3 + (r1 . r2) l3 + (r1 . r3) l2 + (r2 . r3) l1)
  return 2 * std::atan2(r1.dot(r2.cross(r3)), l1 * l2 * l3 + r1.dot(r2) * l3 + r1.dot(r3) * l2 + r2.dot(r3) * l1);
}

}  // namespace patchlight
