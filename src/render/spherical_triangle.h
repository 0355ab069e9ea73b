#pragma once

#include "patchlight/base/geometry.h"

#include <array>

namespace patchlight {

/// A triangle as it is seen from a point.
class SphericalTriangle {
 public:
  SphericalTriangle(const Point& from, const std::array<Point, 3>& corners);

  /// sr; 0 where it is seen from its edge.
  double solid_angle() const { return solid_angle_; }

  /// Uniformly distributed in its solid angle, for (u, v) of the unit square: Arvo 1995, Stratified Sampling of
  /// Spherical Triangles. The solid angle must be above 0.
  Vector direction(double u, double v) const;

  /// True when a direction goes through it.
  bool contains(const Vector& direction) const;

 private:
  Vector a_, b_, c_;  // unit, counter-clockwise
  double solid_angle_ = 0;
  double alpha_ = 0;  // angle at a
};

}  // namespace patchlight
