#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <cstdint>
#include <span>

namespace patchlight {

/// The mesh without the patches for which `is_left_out` is not 0; it has an entry for each patch. Patches and vertices
/// stay in order; vertices that no patch has any more go as well.
PatchMesh without_patches(const PatchMesh& mesh, std::span<const std::uint8_t> is_left_out);

}  // namespace patchlight
