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
  // tan(omega / 2) = a . (b x c) / (1 + a.b + b.c + c.a): Van Oosterom and Strackee 1983, eq. 8
  solid_angle_ = 2 * std::atan2(a_.dot(b_.cross(c_)), 1 + a_.dot(b_) + b_.dot(c_) + c_.dot(a_));
  if (!(solid_angle_ > 0)) solid_angle_ = 0;
  const Vector ab = across(b_, a_), ac = across(c_, a_);
  alpha_ = std::atan2(ab.cross(ac).norm(), ab.dot(ac));
}

Vector SphericalTriangle::direction(double u, double v) const {
  // The part of the triangle on b's side of the great circle through b and c' has u of its area.
  const double phi = u * solid_angle_ - alpha_;
  const double s = std::sin(phi), t = std::cos(phi);
  const double sine = std::sin(alpha_), cosine = std::cos(alpha_);
  const double p = t - cosine;
  const double q = s + sine * a_.dot(b_);
  const double below = (q * s + p * t) * sine;
  const double along = below == 0 ? 1 : std::clamp(((q * t - p * s) * cosine - q) / below, -1.0, 1.0);
  const Vector c = along * a_ + std::sqrt(1 - along * along) * across(c_, a_);
  const double z = 1 - v * (1 - c.dot(b_));
  const Vector side = c - c.dot(b_) * b_;
  if (!(side.norm() > 0)) return b_;
  return (z * b_ + std::sqrt(std::max(0.0, 1 - z * z)) * side.normalized()).normalized();
}

bool SphericalTriangle::contains(const Vector& direction) const {
  return direction.dot(a_.cross(b_)) >= 0 && direction.dot(b_.cross(c_)) >= 0 && direction.dot(c_.cross(a_)) >= 0;
}

}  // namespace patchlight
