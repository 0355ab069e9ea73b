#include "pipeline/lit_problem.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/mirrored_irradiance.h"
#include "mesh/small_patches.h"
#include "pipeline/problem_of.h"
#include "plan/goal.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

DirectIrradiance direct_irradiance_as_planned(const Run& run, const Plan& plan, const PatchMesh& mesh,
                                              LightingOptions options) {
  options.areas = important_areas(mesh, plan.goal.get());
  const auto trace = [&](const Lighting& lighting) {
    DirectIrradiance direct = direct_irradiance(lighting, mesh, options, run.observer);
    if (lighting.mirrors) add(direct, mirrored_irradiance(lighting, {}, mesh, options, run.observer));
    return direct;
  };
  if (plan.lamp_colour.size() == 0) return trace(run.world->lighting());
  // All light has the lamps' color, and nothing changes it on the way: all bands follow from one.
  const DirectIrradiance found = trace(run.world->lighting_in_one_band());
  const auto in_all = [&](const Field& field) { return Field(field.matrix() * plan.lamp_colour.matrix()); };
  return {in_all(found.irradiance), in_all(found.standard_error)};
}

}  // namespace

bool takes_few_rays(const Plan& plan, PatchIndex patches) {
  return patches > many_patches || (refines(plan.accuracy) && plan.assembly.storage == Storage::rays);
}

std::uint64_t seed_on(const Known& known, std::uint64_t seed) {
  return known.meshes == 0 ? seed : hash({seed, stream::later_meshes, known.meshes});
}

LightingOptions lighting_options(const Plan& plan, const PatchMesh& mesh) {
  LightingOptions options{.seed = plan.assembly.seed};
  if (takes_few_rays(plan, mesh.size())) options.mirrored_samples = 16;
  return options;
}

namespace {

// Light of which some is known from the mesh before; the rest with as many more rays as are wanted.
DirectIrradiance direct_irradiance_beside(const Known& known, const Run& run, const Plan& plan, const PatchMesh& mesh,
                                          LightingOptions options) {
  if (!known.light) return direct_irradiance_as_planned(run, plan, mesh, options);
  // 1. The light that is not known, on a mesh of its own, by rays that have not decided how many it takes.
  std::vector<std::uint8_t> is_known;
  std::vector<std::uint8_t> doublings;
  const std::vector<std::uint8_t>& more = known.more_rays.to_lights;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    is_known.push_back(known.light_place[i] != no_patch ? 1 : 0);
    if (is_known.back() == 0) doublings.push_back(more.empty() ? 0 : more[i]);
  }
  PatchMesh whole = mesh;
  whole.middles.clear();
  options.usual_area = mean_area(important_areas(mesh, plan.goal.get()));
  options.doublings = doublings;
  options.seed = seed_on(known, options.seed);
  const DirectIrradiance found = direct_irradiance_as_planned(run, plan, without_patches(whole, is_known), options);

  // 2. With the light that is.
  const auto joined = [&](const Field& before, const Field& now) {
    Field all(mesh.size(), now.cols());
    Eigen::Index next = 0;
    for (PatchIndex i = 0; i < mesh.size(); ++i)
      all.row(i) = is_known[i] != 0 ? before.row(known.light_place[i]) : now.row(next++);
    return all;
  };
  return {joined(known.light->irradiance, found.irradiance), joined(known.light->standard_error, found.standard_error)};
}

}  // namespace

LitProblem lit_problem(const Run& run, const Plan& plan, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                       const Known& known) {
  LitProblem lit{problem_of(run.scene, mesh, exposed_area, plan.sides.emit_from_back, reflections_of(plan)), {}};
  if (!has_point_or_daylight(run.scene)) return lit;
  DirectIrradiance direct = direct_irradiance_beside(known, run, plan, mesh, lighting_options(plan, mesh));
  lit.problem.direct_irradiance = std::move(direct.irradiance);
  lit.direct_standard_error = std::move(direct.standard_error);
  lit.doublings = known.more_rays.to_lights;
  return lit;
}

DirectIrradiance over_exposed_part(DirectIrradiance direct, const PatchMesh& mesh, const LostShare& lost,
                                   const Eigen::VectorXd& exposed_area, std::span<const std::uint8_t> doublings) {
  if (direct.irradiance.size() == 0) return direct;
  const Eigen::ArrayXd factor = over_exposed_part(mesh, lost, exposed_area);
  direct.irradiance.colwise() *= factor;
  direct.standard_error.colwise() *= factor;
  direct.standard_error = with_errors_around(mesh, exposed_area, direct.standard_error, doublings);
  return direct;
}

LitProblem over_exposed_part(LitProblem lit, const PatchMesh& mesh, const LostShare& lost) {
  RadiosityProblem& problem = lit.problem;
  DirectIrradiance direct{std::move(problem.direct_irradiance), std::move(lit.direct_standard_error)};
  direct = over_exposed_part(std::move(direct), mesh, lost, problem.area, lit.doublings);
  problem.direct_irradiance = std::move(direct.irradiance);
  lit.direct_standard_error = std::move(direct.standard_error);
  return lit;
}

Field rough_direct_irradiance(const Run& run, const Plan& plan, const PatchMesh& quarters, std::uint64_t seed,
                              int rays) {
  const int to_lights = std::clamp(rays, 2, 8);
  const LightingOptions few{.lamp_samples = to_lights,
                            .sun_samples = to_lights,
                            .mirrored_samples = std::clamp(rays / 2, 2, 8),
                            .sky_samples = std::clamp(4 * rays, 16, 64),
                            .seed = seed,
                            .alike = 4};
  return direct_irradiance_as_planned(run, plan, quarters, few).irradiance;
}

}  // namespace patchlight
