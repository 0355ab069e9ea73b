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

  /// The mean over its corners of the cosines to a normal, 0 for those below the horizon: about that of its directions.
  double mean_cosine(const Vector& normal) const;

 private:
  Vector a_, b_, c_;     // unit, counter-clockwise
  Vector ab_, bc_, ca_;  // across its edges, inwards
  double solid_angle_ = 0;
};

}  // namespace patchlight
