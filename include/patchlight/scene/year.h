#pragma once

#include "patchlight/scene/daylight.h"

#include <vector>

namespace patchlight {

/// Sun and sky of every hour of a year, hour after hour from the first of January; skies with the radiance of the
/// ground. All suns have one color, and all skies. An hour without light has neither.
struct Year {
  std::vector<Daylight> hours;
  double ground_reflectance = 0.2;  ///< from which Sky::ground_radiance follows
};

}  // namespace patchlight
