#include "form_factor/point_polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace patchlight {

double point_to_polygon(const Point& point, const Vector& normal, std::span<const Point> polygon) {
  // Cut away the part below the horizon; most polygons lie above.
  const auto below = [&](const Point& corner) { return normal.dot(corner - point) < 0; };
  std::vector<Point> clipped;
  if (std::any_of(polygon.begin(), polygon.end(), below)) {
    clipped = clip_to_half_space(polygon, point, normal);
    polygon = clipped;
  }

  // F = -1/(2 pi) sum_k n . (R_k x R_k+1) atan2(|R_k x R_k+1|, R_k . R_k+1) / |R_k x R_k+1|
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector here = polygon[k] - point;
    const Vector next = polygon[k + 1 < polygon.size() ? k + 1 : 0] - point;
    const Vector cross = here.cross(next);
    const double length = cross.norm();
    if (length > 0) sum -= normal.dot(cross) / length * std::atan2(length, here.dot(next));
  }
  return std::clamp(sum / (2 * std::numbers::pi), 0.0, 1.0);
}

namespace {

// The part of `vector` orthogonal to the unit vector `axis`, as a unit vector.
Vector orthogonal_part(const Vector& vector, const Vector& axis) {
  return (vector - vector.dot(axis) * axis).normalized();
}

// Direction uniformly distributed over the spherical triangle of the unit vectors A, B, C with area `area`. Arvo 1995,
// section 2.
Vector spherical_triangle_direction(const Vector& A, const Vector& B, const Vector& C, double area, double u,
                                    double v) {
  // 1. The angle at A, and the arc from A to B.
  const Vector toward_B = orthogonal_part(B, A);
  const Vector toward_C = orthogonal_part(C, A);
  const double cos_alpha = std::clamp(toward_B.dot(toward_C), -1.0, 1.0);
  const double sin_alpha = std::sqrt(1 - cos_alpha * cos_alpha);
  const double alpha = std::acos(cos_alpha);

  // 2. The point C' on the arc A C for which the triangle A B C' has the share u of the area.
  const double s = std::sin(u * area - alpha);
  const double t = std::cos(u * area - alpha);
  const double p = t - cos_alpha;
  const double r = s + sin_alpha * A.dot(B);
  const double q = std::clamp(((r * t - p * s) * cos_alpha - r) / ((r * s + p * t) * sin_alpha), -1.0, 1.0);
  const Vector C_new = q * A + std::sqrt(1 - q * q) * toward_C;

  // 3. A point on the arc B C'.
  const double z = 1 - v * (1 - C_new.dot(B));
  return z * B + std::sqrt(std::max(0.0, 1 - z * z)) * orthogonal_part(C_new, B);
}

struct Fan {
  std::vector<double> solid_angles;  // of the triangles (0, k, k + 1)
  double total = 0;
};

Fan solid_angles_of(const Point& from, std::span<const Point> polygon) {
  Fan fan;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    // Negative when seen from the front.
    fan.solid_angles.push_back(std::max(0.0, -signed_solid_angle(from, polygon[0], polygon[k], polygon[k + 1])));
    fan.total += fan.solid_angles.back();
  }
  return fan;
}

}  // namespace

SeenPoint sample_seen_point(const Point& from, std::span<const Point> polygon, double u, double v) {
  const Fan fan = solid_angles_of(from, polygon);
  if (!(fan.total > 0)) return {};

  // 1. One of the triangles, by solid angle; u is stretched to be used again.
  double rest = u * fan.total;
  std::size_t k = 0;
  while (k + 1 < fan.solid_angles.size() && rest >= fan.solid_angles[k]) rest -= fan.solid_angles[k++];
  const double stretched = std::clamp(rest / fan.solid_angles[k], 0.0, 1.0);
  const Point& a = polygon[0];
  const Point& b = polygon[k + 1];
  const Point& c = polygon[k + 2];
  const Vector plane_normal = (b - a).cross(c - a);

  // 2. A triangle so small that the formulas for spherical ones cancel, as if it were plane: by area, which counts for
  //    cos / d^2 of the solid angle.
  if (fan.solid_angles[k] < 1e-4) {
    const double root = std::sqrt(stretched);
    const Point point = a + root * (1 - v) * (b - a) + root * v * (c - a);
    const Vector way = from - point;
    const double weight = plane_normal.dot(way) / (2 * std::pow(way.norm(), 3)) / fan.solid_angles[k];
    return {point, fan.total, weight};
  }
  const Vector direction = spherical_triangle_direction((a - from).normalized(), (b - from).normalized(),
                                                        (c - from).normalized(), fan.solid_angles[k], stretched, v);
  const Point point = from + plane_normal.dot(a - from) / plane_normal.dot(direction) * direction;
  // From a point on an edge or in the plane itself the spherical triangle has no angle: any point of it will do.
  return {point.allFinite() ? point : Point((a + b + c) / 3), fan.total, 1};
}

PolygonSample sample_solid_angle(const Point& from, const Vector& normal, std::span<const Point> polygon, double u,
                                 double v) {
  const std::vector<Point> above_horizon = clip_to_half_space(polygon, from, normal);
  if (above_horizon.empty()) return {};
  const SeenPoint seen = sample_seen_point(from, above_horizon, u, v);
  if (!(seen.solid_angle > 0)) return {};
  const double cosine = normal.dot((seen.point - from).normalized());
  return {seen.point, std::max(0.0, cosine) * seen.solid_angle * seen.weight / std::numbers::pi};
}

}  // namespace patchlight
