#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"
#include "patchlight/visibility/occluder.h"

#include <string>
#include <vector>

namespace patchlight {

/// A sentence for each sensor of the scene whose reading is hardly meant, with its file and line; at most five, and
/// then one that counts the rest. A sensor is inside a wall when 64 rays in all directions meet a side that takes no
/// part, every one of them. It is too close to a surface when it is nearer than 1e-6 of the scene's extent, so that
/// rounding decides which side of it light comes from, unless it lies on that surface and faces along its normal. The
/// occluder must be one of all polygons. O(sensors x polygons).
std::vector<std::string> doubtful_sensors(const Scene& scene, const KeptSides& sides, const Occluder& occluder);

}  // namespace patchlight
