#include "render/spherical_triangle.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// The part of `vector` at right angles to a unit `axis`, of length 1.
Vector across(const Vector& vector, const Vector& axis) { return (vector - vector.dot(axis) * axis).normalized(); }

}  // namespace

SphericalTriangle::SphericalTriangle(const Point& from, const std::array<Point, 3>& corners)
    : a_((corners[0] - from).normalized()), b_((corners[1] - from).normalized()), c_((corners[2] - from).normalized()) {
  if (a_.dot(b_.cross(c_)) < 0) std::swap(b_, c_);
  ab_ = a_.cross(b_);
  bc_ = b_.cross(c_);
  ca_ = c_.cross(a_);
  // tan(omega / 2) = a . (b x c) / (1 + a.b + b.c + c.a): Van Oosterom and Strackee 1983, eq. 8
  solid_angle_ = std::max(0.0, 2 * std::atan2(a_.dot(bc_), 1 + a_.dot(b_) + b_.dot(c_) + c_.dot(a_)));
}

Vector SphericalTriangle::direction(double u, double v) const {
  // The angle at a
  const Vector to_b = across(b_, a_), to_c = across(c_, a_);
  const double cosine = std::clamp(to_b.dot(to_c), -1.0, 1.0), sine = to_b.cross(to_c).norm();
  const double alpha = std::atan2(sine, cosine);
  // The part of the triangle on b's side of the great circle through b and c' has u of its area.
  const double phi = u * solid_angle_ - alpha;
  const double s = std::sin(phi), t = std::cos(phi);
  const double p = t - cosine;
  const double q = s + sine * a_.dot(b_);
  const double below = (q * s + p * t) * sine;
  const double along = below == 0 ? 1 : std::clamp(((q * t - p * s) * cosine - q) / below, -1.0, 1.0);
  const Vector c = along * a_ + std::sqrt(1 - along * along) * to_c;
  const double z = 1 - v * (1 - c.dot(b_));
  const Vector side = c - c.dot(b_) * b_;
  if (!(side.norm() > 0)) return b_;
  return (z * b_ + std::sqrt(std::max(0.0, 1 - z * z)) * side.normalized()).normalized();
}

bool SphericalTriangle::contains(const Vector& direction) const {
  return direction.dot(ab_) >= 0 && direction.dot(bc_) >= 0 && direction.dot(ca_) >= 0;
}

double SphericalTriangle::mean_cosine(const Vector& normal) const {
  return (std::max(0.0, normal.dot(a_)) + std::max(0.0, normal.dot(b_)) + std::max(0.0, normal.dot(c_))) / 3;
}

}  // namespace patchlight
