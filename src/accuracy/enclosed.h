#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

#include <Eigen/Core>

namespace patchlight {

/// 1 for each patch of a space that holds what light gets in, as a room with windows does; else 0, as for facades, a
/// court or the ground under a table in the open. Light that goes on from the patch by four diffuse reflections,
/// whatever the reflectance, leaves the scene with a probability below one half; clear faces count as closed. `faces`
/// is an occluder whose rays meet all polygons. Costs at most 64 rays a patch.
Eigen::VectorXd enclosed_patches(const Scene& scene, const Occluder& faces, const PatchMesh& mesh);

}  // namespace patchlight
