#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/transport/transport_operator.h"
#include "patchlight/visibility/occluder.h"

#include "lighting/direct_irradiance.h"
#include "solve_mesh.h"

namespace patchlight {

/// Which polygons can stand between two patches: those that may, all when occlusion is forced, none when it is skipped.
Occluder::Blockers blockers_of(const Plan& plan);

/// The scene with the lights that the plan simulates; without differences of colour when these are skipped by force:
/// every spectrum is replaced by its luminance (light/photometry.h), the same in all bands.
Scene scene_as_planned(Scene scene, const Plan& plan);

/// The scene as sensors see it, which may stand where no patch is: only what is skipped by force gives no light.
Scene scene_for_sensors(Scene scene, const Plan& plan);

/// Irradiance of patches by luminaires, sun and sky; where one band stands for all it is found once. \throws Cancelled.
DirectIrradiance direct_irradiance_as_planned(const Setting& setting, const Plan& plan, const PatchMesh& mesh);

/// Irradiance straight from the patches that emit, F E, by their rows alone. W/m^2. \throws Cancelled.
Field irradiance_by_lamps(const RowTransport& transport, const FieldView& exitance, Stage stage,
                          const Observer& observer);

/// `solve`, or when interreflection is left out the light that comes straight from the lamps: H = F E + H_direct, and
/// B = E + rho o H, in which nothing has been reflected twice.
SolveWith solver_as_planned(SolveWith solve, const Plan& plan);

}  // namespace patchlight
