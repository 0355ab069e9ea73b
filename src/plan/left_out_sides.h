#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

namespace patchlight {

/// Notes for a scene whose lamps may have changed since its sides were chosen: the materials that emit only from sides
/// that are left out, and how many sides `sides` would take today and are left out. Nothing when there are none.
Diagnostics notes_on_left_out_sides(const Scene& scene, const KeptSides& kept, Sides sides);

}  // namespace patchlight
