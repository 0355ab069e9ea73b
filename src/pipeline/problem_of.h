#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/solve/problem.h"

#include "scene/specular_faces.h"

namespace patchlight {

/// The materials of the scene on the patches: lamps emit from their front sides, and from their back sides if asked. A
/// back side with a material of its own is a front side in this. A clear patch, or a mirror, counts as a sheet with
/// holes, of which the share that is not hole, SpecularFaces::held(), reflects and emits all that the patch does:
/// docs/theory.md section 11. `exposed_area` is that of this share.
RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back, Reflections reflections = Reflections::kept);

/// The same simulation with area, reflectance, exitance and radiosity of whole patches, holes and all.
Simulation of_whole_patches(Simulation simulation, const Scene& scene);

}  // namespace patchlight
