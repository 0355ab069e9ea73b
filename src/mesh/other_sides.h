#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <vector>

namespace patchlight {

/// Per patch of a sheet the one on its other side that has the same corners; a patch itself where there is none, as on
/// all other polygons. Empty when the mesh has no sheets. O(n log n).
std::vector<PatchIndex> other_sides(const PatchMesh& mesh);

}  // namespace patchlight
