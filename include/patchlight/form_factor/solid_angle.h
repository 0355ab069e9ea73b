#pragma once

#include "patchlight/base/geometry.h"

#include <span>

namespace patchlight {

/// A point of a polygon chosen at random, and what it contributes to the mean that is the form factor.
struct PolygonSample {
  Point point;
  double weight = 0;  ///< its mean over (u, v) is the unoccluded form factor from the point to the polygon
};

/// A point of a convex polygon, uniformly distributed in the solid angle under which it appears from `from`, above the
/// horizon of `normal`: the weight cos(theta) Omega / pi is bounded however near the polygon is, so the estimate has a
/// finite variance where area sampling has none. Weight 0 when nothing is above the horizon or `from` is behind the
/// polygon. Arvo 1995, Stratified Sampling of Spherical Triangles.
PolygonSample sample_solid_angle(const Point& from, const Vector& normal, std::span<const Point> polygon, double u,
                                 double v);

}  // namespace patchlight
