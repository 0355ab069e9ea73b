#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "lighting/receiver.h"

namespace patchlight {

/// The receiver that a patch of a mesh is, which has to live as long.
Receiver receiver_of(const PatchMesh& mesh, PatchIndex patch);

/// The receiver that a point is, which has to live as long.
Receiver receiver_of(const SurfacePoint& point);

}  // namespace patchlight
