#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// A number per patch that chooses its random points. It follows from where the patch lies in a frame of the scene's
/// own: its centroid, size and principal axes. So the answer does not change when the model is moved or scaled or its
/// faces are given in another order, nor when it is turned, unless it has a symmetry: then the frame is ambiguous,
/// turning it may change the keys, and with them the answer within its statistical error.
std::vector<std::uint32_t> patch_keys(const PatchMesh& mesh);

}  // namespace patchlight
