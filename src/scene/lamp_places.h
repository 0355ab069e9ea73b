#pragma once

#include "patchlight/scene/scene.h"

#include "scene/solids.h"

#include <array>
#include <vector>

namespace patchlight {

/// A source of light as solids see it: the triangles of an emitting side, moved just before it, or a ball around a
/// luminaire, which has no triangles.
struct LampShape {
  std::vector<std::array<Point, 3>> triangles;
  Point middle = Point::Zero();  ///< a point of it
  double radius = 0;             ///< of a ball, metres; 0 for one without extent
  Box box;
};

/// The shapes of every side that emits and of every luminaire.
std::vector<LampShape> lamp_shapes(const Scene& scene, double extent);

/// The distance of a point to the nearest triangle of a solid, m.
double distance_to(const Solid& solid, const Point& point);

/// The distance of a point to a triangle, m.
double distance_to(const std::array<Point, 3>& triangle, const Point& point);

/// Where a lamp lies with respect to a closed solid: both when it crosses the surface, or comes so near to it that
/// rounding decides.
struct LampPlaces {
  bool inside = false;
  bool outside = false;
};

/// Of all lamps together. What lies within 5e-7 of the scene's `extent` of the surface counts as inside and outside: no
/// light is lost for it. O(lamps x triangles of the solid).
LampPlaces places_of(const std::vector<LampShape>& lamps, const Solid& solid, double extent);

}  // namespace patchlight
