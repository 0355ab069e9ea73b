#pragma once

#include "patchlight/plan/plan.h"
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

/// The lines at which patches end, and what there is to say of them.
struct PlannedLines {
  ContactLines lines;
  Diagnostics notes;
};

/// Lines of contact, and the edges of hard shadows where the mesh may know of lights. What is worth a line where an
/// accuracy is asked for is what it can feel, as a share of the area of all kept sides. Where they would be too
/// many the longest alone, and on bent faces none.
PlannedLines planned_lines(const Scene& scene, const Request& request, const KeptSides& sides,
                           const Coverings& coverings, bool knows_lights);

}  // namespace patchlight
