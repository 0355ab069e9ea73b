#pragma once

#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

/// Every patch cut into four by the middles of its edges: patch i becomes the patches 4 i to 4 i + 3, of its kind.
/// Neighbours that share an edge share its middle.
PatchMesh refine(const PatchMesh& mesh);

}  // namespace patchlight
