#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/lost_share.h"

#include "lighting/direct_irradiance.h"
#include "optics/surface_optics.h"
#include "pipeline/run.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Replaces the reflectance of textured patches by the mean of the texture over the patch.
Field with_textures(Field reflectance, const Scene& scene, const PatchMesh& mesh);

/// The radiosity problem of a mesh from the scene's materials. Lamps emit from their front sides, and from their back
/// sides if `emit_from_back`. A back side with its own material counts as a front side. A clear patch or a mirror
/// counts as a sheet with holes: the share SurfaceOptics::nonspecular_fraction() reflects and emits everything, and
/// `exposed_area` is the area of this share. docs/theory/panes-mirrors-sheets.md. For translucent sheets see
/// with_sheets().
RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back, Reflections reflections = Reflections::kept);

/// Adds transmission through sheets to the scattering, for patches with these exposed areas, m^2. Something that lies
/// against one side absorbs the light that gets through there: t_i is the sheet's transmittance times min(A_i, A_j) /
/// A_i, where j is the patch on the other side. The transmission is 0 where one side of a sheet is left out.
Scattering with_sheets(Scattering scattering, const Scene& scene, const PatchMesh& mesh,
                       const Eigen::VectorXd& exposed_area);

/// Converts area, reflectance, exitance and radiosity of a simulation to whole patches, holes included.
Simulation to_geometric_area(Simulation simulation, const Scene& scene);

/// And back: as problem_of() has them.
Simulation to_effective_area(Simulation simulation, const Scene& scene);

/// The problem on a mesh: its materials, and the direct light of luminaires, sun and sky.
struct LitProblem {
  RadiosityProblem problem;
  Field direct_standard_error;               ///< of RadiosityProblem::direct_irradiance, W/m^2; empty with it
  std::vector<std::uint8_t> doublings = {};  ///< MoreRays::to_lights
  Field unfollowed = {};                     ///< DirectIrradiance::unfollowed, W/m^2
};

/// Above these numbers of patches, each patch gets fewer rays: smoothing over nearby patches reduces the noise.
inline constexpr PatchIndex many_patches = 20'000;
inline constexpr PatchIndex very_many_patches = 100'000;

/// True for many patches, and for refinement by rays, where MoreRays adds rays to the patches that need more.
bool takes_few_rays(const Plan& plan, PatchIndex patches);

/// The random seed of a mesh. Reusing rays that decided their own number would bias results.
std::uint64_t seed_on(const Known& known, std::uint64_t seed);

/// The options for sampling luminaires, sun and sky on these patches.
LightingOptions lighting_options(const Plan& plan, const PatchMesh& mesh);

/// `exposed_area` is that of problem_of(). Where one band stands for all, direct light is computed once. \throws
/// Canceled.
LitProblem lit_problem(const Run& run, const Plan& plan, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                       const Known& known = {});

/// Converts light averaged over each patch, without the part under other polygons, into averages over its exposed area,
/// m^2. Standard errors are at least those of nearby patches, scaled by the number of rays. Empty where there is no
/// such light.
DirectIrradiance over_exposed_part(DirectIrradiance direct, const PatchMesh& mesh, const LostShare& lost,
                                   const Eigen::VectorXd& exposed_area, std::span<const std::uint8_t> doublings = {});

/// The same for the direct light of lit_problem(), over RadiosityProblem::area.
LitProblem over_exposed_part(LitProblem lit, const PatchMesh& mesh, const LostShare& lost);

/// A rough estimate of the irradiance by luminaires, sun and sky, W/m^2, on the four quarters (rows) of each patch. The
/// quarters are the patches of `quarters`. `rays` (limited to 2 to 8) go from a patch of mean size to each luminaire
/// and the sun, and eight times as many (16 to 64) to the sky. Other patches follow LightingOptions. Each path by
/// mirrors takes half of `rays` (2 to 8). Quarters with equal ray counts use the same samples, which `seed` chooses.
/// \throws Canceled.
Field rough_direct_irradiance(const Run& run, const Plan& plan, const PatchMesh& quarters, std::uint64_t seed,
                              int rays);

}  // namespace patchlight
