#pragma once

#include "patchlight/scene/scene.h"

#include "scene/solids.h"

#include <vector>

namespace patchlight {

/// The dark solids of kept_sides(): bodies that no light gets into. None in a scene without light.
std::vector<Solid> dark_solids(const Scene& scene);

}  // namespace patchlight
