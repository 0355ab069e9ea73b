#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <span>
#include <vector>

namespace patchlight {

/// The vertices of a patch's three or four corners.
std::span<const std::uint32_t> corner_vertices(const PatchMesh& mesh, PatchIndex patch);

/// The patches that have a corner at each vertex.
std::vector<std::vector<PatchIndex>> patches_at_vertices(const PatchMesh& mesh);

}  // namespace patchlight
