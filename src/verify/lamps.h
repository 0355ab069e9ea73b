#pragma once

#include "patchlight/scene/scene.h"

#include "verify/surfaces.h"

#include <array>
#include <vector>

namespace patchlight {

/// A piece of an emitting side.
struct LampTriangle {
  std::array<Point, 3> corners;
  PolygonIndex polygon = 0;
  Side side = Side::front;
};

/// A point of an emitting side.
struct LampPoint {
  Point point;
  PolygonIndex polygon = 0;
  Side side = Side::front;
};

/// All that emits, to be sampled by area: each square metre in proportion to its exitance, mean of the bands.
struct Lamps {
  std::vector<LampTriangle> triangles;
  std::vector<double> flux_before;  ///< of the triangles before each, mean of the bands, W
  double flux = 0;                  ///< of all, W
};

Lamps lamps_of(const Scene& scene, const Surfaces& surfaces);

/// The point that belongs to (u, v) in the unit square: the density of points is sampling_density(). There must be a
/// lamp.
LampPoint sample(const Lamps& lamps, double u, double v);

/// The density with which points of a surface are sampled, 1/m^2.
double sampling_density(const Lamps& lamps, const Surface& surface);

}  // namespace patchlight
