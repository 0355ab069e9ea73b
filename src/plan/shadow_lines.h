#pragma once

#include "patchlight/scene/contact_lines.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "scene/coverings.h"
#include "scene/light_place.h"

#include <vector>

namespace patchlight {

/// The edges of the shadows that polygons throw in the light of these places, on the polygons that they fall on: at the
/// index of each polygon. Only where light passes the edge and the polygon is kept on the side that it reaches; what is
/// clear throws none. Every edge that the light passes on one side is followed by 16 rays, or by 128 where
/// these tell of several stretches: shorter ones than such a part of the edge may be missed. Lines end where others or
/// the outline cut them. O(n log n) for n polygons.
std::vector<std::vector<ContactLine>> find_shadow_lines(const Scene& scene, const KeptSides& kept,
                                                        const Coverings& coverings,
                                                        const std::vector<LightPlace>& lights);

}  // namespace patchlight
