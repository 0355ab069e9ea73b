#pragma once

#include "patchlight/base/geometry.h"

#include <span>

namespace patchlight {

/// Unoccluded form factor in [0, 1] from a differential area at `point` with unit `normal` to a planar polygon. The
/// part of the polygon below the point's horizon is excluded. 0 when the point is behind the polygon's front side, from
/// which its corners run counter-clockwise. Lambert 1760; docs/theory/unoccluded-form-factors.md.
double point_to_polygon(const Point& point, const Vector& normal, std::span<const Point> polygon);

/// A point of a polygon chosen at random by the solid angle under which the polygon appears.
struct SeenPoint {
  Point point;
  double solid_angle = 0;  ///< of the whole polygon, sr; 0 when it is seen from behind or not at all
  double weight = 0;  ///< 1; for a polygon so small that it is sampled by area, the solid angle per area at the point,
                      ///< relative to the mean
};

/// A point of a convex polygon, seen from `from`: the mean of solid_angle weight f(point) over (u, v) is the integral
/// of f over the solid angle. Arvo 1995, Stratified Sampling of Spherical Triangles.
SeenPoint sample_seen_point(const Point& from, std::span<const Point> polygon, double u, double v);

/// A random point of a polygon, and its contribution to the form factor, which is a mean.
struct PolygonSample {
  Point point;
  double weight = 0;  ///< its mean over (u, v) is the unoccluded form factor from the point to the polygon
};

/// A point of a convex polygon, distributed uniformly in the solid angle that the polygon subtends at `from` above the
/// horizon of `normal`. The weight cos(theta) Omega / pi is bounded however near the polygon is. So the estimate has a
/// finite variance, unlike area sampling. Weight 0 when nothing is above the horizon or `from` is behind the polygon.
PolygonSample sample_solid_angle(const Point& from, const Vector& normal, std::span<const Point> polygon, double u,
                                 double v);

}  // namespace patchlight
