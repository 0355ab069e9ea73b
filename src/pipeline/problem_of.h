#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/solve/problem.h"

#include "scene/specular_faces.h"

namespace patchlight {

/// The reflectances of patches with those that lie in a picture replaced by the mean of the picture over the patch.
Field with_textures(Field reflectance, const Scene& scene, const PatchMesh& mesh);

/// The materials of the scene on the patches: lamps emit from their front sides, and from their back sides if asked. A
/// back side with a material of its own is a front side in this. A clear patch, or a mirror, counts as a sheet with
/// holes, of which the share that is not hole, SpecularFaces::held(), reflects and emits all that the patch does:
/// docs/theory/panes-mirrors-sheets.md. `exposed_area` is that of this share. Of sheets see with_sheets().
RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back, Reflections reflections = Reflections::kept);

/// The scattering with what goes through sheets, for patches with these exposed areas, m^2. Where something lies
/// against one side, what gets through there is absorbed: t_i is the sheet's transmittance times min(A_i, A_j) / A_i, j
/// the patch on the other side. Nothing goes through where one side of a sheet takes no part.
Scattering with_sheets(Scattering scattering, const Scene& scene, const PatchMesh& mesh,
                       const Eigen::VectorXd& exposed_area);

/// The same simulation with area, reflectance, exitance and radiosity of whole patches, holes and all.
Simulation of_whole_patches(Simulation simulation, const Scene& scene);

/// And back: as problem_of() has them.
Simulation of_held_parts(Simulation simulation, const Scene& scene);

}  // namespace patchlight
