#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/contact_lines.h"
#include "patchlight/scene/sides.h"

#include <string>
#include <vector>

namespace patchlight {

/// The lines at which patches end, and what there is to say of them.
struct PlannedLines {
  ContactLines lines;
  std::vector<std::string> notes;
};

/// Lines of contact, and the edges of hard shadows where the mesh may know of lights. What is worth a line where an
/// accuracy is asked for is what it can feel, as a share of the area of all kept sides. None where they would be too
/// many, or where bent faces leave open which of them touch.
PlannedLines planned_lines(const Scene& scene, const Request& request, const KeptSides& sides, bool knows_lights);

}  // namespace patchlight
