#pragma once

#include "patchlight/scene/scene.h"

#include <array>
#include <vector>

namespace patchlight {

/// A triangle, whose last corner comes twice, or a convex quadrilateral that emits from its front.
struct LampFace {
  std::array<Point, 4> corners;
  Vector normal;  ///< unit
  double area = 0;
  PolygonIndex polygon = no_polygon;
  Spectrum exitance;  ///< W/m^2
};

/// The triangles and convex quadrilaterals of a side of a polygon that emits.
std::vector<LampFace> lamp_faces(const Scene& scene, PolygonIndex polygon, Side side);

}  // namespace patchlight
