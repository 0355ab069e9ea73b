#pragma once

#include "patchlight/scene/scene.h"

#include "scene/shells.h"
#include "scene/solids.h"

#include <vector>

namespace patchlight {

/// Shells with rims that other shells close, as solids: a block without a bottom on a floor, a column without ends, a
/// cupboard without a back before a wall. Every rim runs in one plane, within weld_distance(), over opaque faces that
/// fill it. Their triangles include lids over the rims, which belong to no polygon. Rims of more than 1000 corners, and
/// those that more than 1000 triangles lie under, are left open. O(n log n) for n polygons, expected.
std::vector<Solid> standing_solids(const Scene& scene, const Shells& shells);

}  // namespace patchlight
