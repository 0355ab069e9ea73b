#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// What lights a scene in which nothing emits.
struct FirstLight {
  std::string setting;  ///< of a request, as read.daylight.sky=overcast:10000lx; empty: it takes a scene file
  std::string advice;   ///< all that can light it, `setting` among it, a problem and a "hint: " line for each remedy
};

/// Of a room that no daylight gets into, sealed_hull(), the material that looks like a lamp, or a luminaire in a scene
/// file where none does; of other scenes the sky. The advice names materials that look like lamps with the settings
/// that switch them on, and where daylight and luminaires are described. O(n log n) for n corners.
FirstLight first_light(const Scene& scene);

}  // namespace patchlight
