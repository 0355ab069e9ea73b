#pragma once

#include "patchlight/base/geometry.h"

namespace patchlight {

/// Where a light without extent is: a point, or a direction.
struct LightPlace {
  Vector at;          ///< a point, m, or a unit vector towards the light
  double weight = 0;  ///< 1 for a point, 0 for a direction

  /// Towards the light, of any length.
  Vector way_from(const Point& point) const { return at - weight * point; }
};

}  // namespace patchlight
