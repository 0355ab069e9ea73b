#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/lighting/direct_irradiance.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/visibility/occluder.h"

namespace patchlight {

/// Which polygons can stand between two patches: those that may, all when occlusion is forced, none when it is skipped.
Occluder::Blockers blockers_of(const Plan& plan);

/// The scene with the lights that the plan simulates; without differences of colour when these are skipped by force:
/// every spectrum is replaced by its luminance (light/photometry.h), the same in all bands.
Scene scene_as_planned(Scene scene, const Plan& plan);

/// Irradiance of patches by luminaires, sun and sky; where one band stands for all it is found once.
DirectIrradiance direct_irradiance_as_planned(const Scene& scene, const Coverings& coverings, const Plan& plan,
                                              const PatchMesh& mesh, const Observer& observer);

/// `solve`, or when interreflection is left out the light that comes straight from the lamps: H = F E + H_direct, and
/// B = E + rho o H, in which nothing has been reflected twice.
SolveWith solver_as_planned(SolveWith solve, const Plan& plan);

}  // namespace patchlight
