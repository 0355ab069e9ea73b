#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/contact_lines.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "scene/coverings.h"
#include "scene/light_place.h"

#include <vector>

namespace patchlight {

/// The edges of the shadows that polygons cast in the light of these places, at the index of each polygon that they
/// fall on. Included are edges that light passes, on sides that are kept; clear faces cast none. Every edge that light
/// passes on one side is sampled by 16 rays, or by 128 where these find several stretches. Stretches shorter than such
/// a part of the edge may be missed. Lines end at other lines and at the outline. O(n log n) for n polygons.
std::vector<std::vector<ContactLine>> find_shadow_lines(const Scene& scene, const KeptSides& kept,
                                                        const Coverings& coverings,
                                                        const std::vector<LightPlace>& lights);

/// The lines at which patches end, and the notes on them.
struct PlannedLines {
  ContactLines lines;
  Diagnostics notes;
};

/// Lines of contact, and the edges of hard shadows where the mesh may depend on lights. With a requested accuracy only
/// lines that affect it are kept, by their share of the area of all kept sides. If there are too many, the longest
/// remain, and none on curved faces.
PlannedLines planned_lines(const Scene& scene, const Request& request, const KeptSides& sides,
                           const Coverings& coverings, bool knows_lights);

}  // namespace patchlight
