#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/contact_lines.h"
#include "patchlight/scene/sides.h"

#include "scene/coverings.h"

namespace patchlight {

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
