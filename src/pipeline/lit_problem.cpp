#include "pipeline/lit_problem.h"

#include "lighting/mirrored_irradiance.h"
#include "pipeline/problem_of.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

DirectIrradiance direct_irradiance_as_planned(const Run& run, const Plan& plan, const PatchMesh& mesh,
                                              const LightingOptions& options) {
  const auto trace = [&](const Scene& scene) {
    const Lighting lighting = lighting_of(scene, *run.tracing);
    DirectIrradiance direct = direct_irradiance(lighting, mesh, options, run.observer);
    if (lighting.mirrors) add(direct, mirrored_irradiance(lighting, {}, mesh, options, run.observer));
    return direct;
  };
  if (plan.lamp_colour.size() == 0) return trace(run.scene);
  // All light has the lamps' colour, and nothing changes it on the way: one band tells all.
  Eigen::Index brightest = 0;
  plan.lamp_colour.maxCoeff(&brightest);
  const DirectIrradiance found = trace(in_one_band(run.scene, brightest));
  const auto in_all = [&](const Field& field) { return Field(field.matrix() * plan.lamp_colour.matrix()); };
  return {in_all(found.irradiance), in_all(found.standard_error)};
}

}  // namespace

LightingOptions lighting_options(const Plan& plan, const PatchMesh& mesh) {
  constexpr int over_mirrors_of_many = 16;
  LightingOptions options{.seed = plan.assembly.seed};
  if (mesh.size() > many_patches) options.mirrored_samples = over_mirrors_of_many;
  return options;
}

LitProblem lit_problem(const Run& run, const Plan& plan, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area) {
  LitProblem lit{problem_of(run.scene, mesh, exposed_area, plan.sides.emit_from_back, reflections_of(plan)), {}};
  if (!has_point_or_daylight(run.scene)) return lit;
  DirectIrradiance direct = direct_irradiance_as_planned(run, plan, mesh, lighting_options(plan, mesh));
  lit.problem.direct_irradiance = std::move(direct.irradiance);
  lit.direct_standard_error = std::move(direct.standard_error);
  return lit;
}

DirectIrradiance over_exposed_part(DirectIrradiance direct, const PatchMesh& mesh, const LostShare& lost,
                                   const Eigen::VectorXd& exposed_area) {
  if (direct.irradiance.size() == 0) return direct;
  const Eigen::ArrayXd factor = over_exposed_part(mesh, lost, exposed_area);
  direct.irradiance.colwise() *= factor;
  direct.standard_error.colwise() *= factor;
  direct.standard_error = with_errors_around(mesh, exposed_area, direct.standard_error);
  return direct;
}

LitProblem over_exposed_part(LitProblem lit, const PatchMesh& mesh, const LostShare& lost) {
  RadiosityProblem& problem = lit.problem;
  DirectIrradiance direct{std::move(problem.direct_irradiance), std::move(lit.direct_standard_error)};
  direct = over_exposed_part(std::move(direct), mesh, lost, problem.area);
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
                            .sky_samples = std::clamp(8 * rays, 16, 64),
                            .seed = seed,
                            .alike = 4};
  return direct_irradiance_as_planned(run, plan, quarters, few).irradiance;
}

}  // namespace patchlight
