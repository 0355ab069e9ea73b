#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/lost_share.h"

#include "lighting/direct_irradiance.h"
#include "pipeline/run.h"
#include "scene/specular_faces.h"

#include <cstdint>
#include <span>
#include <vector>

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

/// The problem on a mesh: its materials, and the light of luminaires, sun and sky where it first arrives.
struct LitProblem {
  RadiosityProblem problem;
  Field direct_standard_error;               ///< of RadiosityProblem::direct_irradiance, W/m^2; empty with it
  std::vector<std::uint8_t> doublings = {};  ///< MoreRays::to_lights
};

/// Above these numbers of patches fewer rays are taken of each: smoothing over those around reduces the noise.
inline constexpr PatchIndex many_patches = 20'000;
inline constexpr PatchIndex very_many_patches = 100'000;

/// True for many patches, and on the way to an accuracy by rows of rays, where those that need more get them by
/// MoreRays.
bool takes_few_rays(const Plan& plan, PatchIndex patches);

/// The random seed on a mesh. Rays that have decided how many it takes are not used again, which would bias results.
std::uint64_t seed_on(const Known& known, std::uint64_t seed);

/// The rays for the light of luminaires, sun and sky on these patches.
LightingOptions lighting_options(const Plan& plan, const PatchMesh& mesh);

/// `exposed_area` as problem_of() takes it. Where one band stands for all, direct light is found once. \throws
/// Cancelled.
LitProblem lit_problem(const Run& run, const Plan& plan, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                       const Known& known = {});

/// Converts light averaged over each patch but for the part under other polygons into averages over its exposed area,
/// m^2; standard errors no less than those around, each by as many rays. Empty where there is no such light.
DirectIrradiance over_exposed_part(DirectIrradiance direct, const PatchMesh& mesh, const LostShare& lost,
                                   const Eigen::VectorXd& exposed_area, std::span<const std::uint8_t> doublings = {});

/// The same of the direct light of lit_problem(), over RadiosityProblem::area.
LitProblem over_exposed_part(LitProblem lit, const PatchMesh& mesh, const LostShare& lost);

/// The irradiance by luminaires, sun and sky alone, W/m^2, of the four quarters (rows) of each patch, which are the
/// patches of `quarters`: of a patch of mean size with `rays`, from 2 to 8, to each luminaire and the sun, eight times
/// as many to the sky, from 16 to 64, others by LightingOptions, and over each way by mirrors half of `rays`, from 2
/// to 8. Quarters that take as many take the same samples; `seed` chooses them. \throws Cancelled.
Field rough_direct_irradiance(const Run& run, const Plan& plan, const PatchMesh& quarters, std::uint64_t seed,
                              int rays);

}  // namespace patchlight
