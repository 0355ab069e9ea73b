#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <vector>

namespace patchlight {

/// Several models as one scene, in their order; unit and upright axis are those of the first. Materials with the same
/// name and values become one; those with the same name and other values are kept apart, the later one named after its
/// file, "wall (b.obj)", and a note says so.
Scene merge_scenes(std::vector<Scene> scenes);

}  // namespace patchlight
