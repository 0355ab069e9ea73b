#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/solve/problem.h"

namespace patchlight {

/// The materials of the scene on the patches: lamps emit from their front sides, and from their back sides if asked. A
/// back side with a material of its own is a front side in this.
RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back);

}  // namespace patchlight
