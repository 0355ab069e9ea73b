#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "lighting/receiver.h"

#include <span>
#include <vector>

namespace patchlight {

/// A receiver for each patch of a mesh, which has to live as long.
std::vector<Receiver> receivers_of(const PatchMesh& mesh);

/// A receiver for each of some points, which have to live as long.
std::vector<Receiver> receivers_of(std::span<const SurfacePoint> points);

}  // namespace patchlight
