#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>

namespace patchlight {

/// A right-handed frame that turns with the patch: along its first edge, across it, and along the normal.
Eigen::Matrix3d patch_frame(const PatchMesh& mesh, PatchIndex patch);

}  // namespace patchlight
