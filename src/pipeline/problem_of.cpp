#include "pipeline/problem_of.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "light/texture.h"
#include "mesh/nested_mesh.h"
#include "plan/goal.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <utility>

namespace patchlight {
namespace {

// The patches of each material that lie in its picture.
std::vector<std::vector<PatchIndex>> textured_patches(const Scene& scene, const PatchMesh& mesh) {
  std::vector<std::vector<PatchIndex>> patches(scene.materials.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (texture_map_on(scene, scene.polygons[mesh.polygon[i]], mesh.side[i])) patches[mesh.material[i]].push_back(i);
  }
  return patches;
}

// From areas a to areas a / f, with B, E and rho times f: the same flux. f is the share of light from all directions
// alike that a patch holds, or its inverse.
Simulation of_other_parts(Simulation simulation, const Scene& scene, bool whole) {
  const SurfaceOptics specular(scene, reflections_of(simulation.plan));
  const PatchMesh& mesh = simulation.mesh;
  RadiosityProblem& problem = simulation.problem;
  Solution& solution = simulation.solution;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const double nonspecular = specular.nonspecular_fraction(mesh.polygon[i], mesh.side[i]);
    const double factor = whole ? nonspecular : 1 / nonspecular;
    if (factor == 1) continue;
    problem.area[i] /= factor;
    for (Field* field : {&problem.scattering.reflectance, &problem.exitance, &solution.radiosity, &solution.error})
      if (field->rows() > 0) field->row(i) *= factor;
  }
  return simulation;
}

DirectIrradiance direct_irradiance_as_planned(const Run& run, const Plan& plan, const PatchMesh& mesh,
                                              LightingOptions options) {
  options.areas = important_areas(mesh, plan.goal.get());
  const auto trace = [&](const Lighting& lighting) { return direct_irradiance(lighting, mesh, options, run.observer); };
  if (plan.lamp_colour.size() == 0) return trace(run.world->lighting());
  // All light has the lamps' color, and nothing changes it on the way: all bands follow from one.
  const DirectIrradiance found = trace(run.world->lighting_in_one_band());
  const auto in_all = [&](const Field& field) { return Field(field.matrix() * plan.lamp_colour.matrix()); };
  return {in_all(found.irradiance), in_all(found.standard_error), in_all(found.unfollowed)};
}

// Light that is partly known from the previous mesh. The rest is computed with the requested multiple of rays.
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
  const DirectIrradiance& light = *known.light;
  return {joined(light.irradiance, found.irradiance), joined(light.standard_error, found.standard_error),
          joined(light.unfollowed, found.unfollowed)};
}

}  // namespace

Field with_textures(Field reflectance, const Scene& scene, const PatchMesh& mesh) {
  const std::vector<std::vector<PatchIndex>> textured = textured_patches(scene, mesh);
  for (std::size_t m = 0; m < textured.size(); ++m) {
    if (textured[m].empty()) continue;
    const TexturedReflectance& surface = *scene.materials[m].texture;
    const TextureMeans means(surface);
    parallel_for(textured[m].size(), [&](std::size_t k) {
      const PatchIndex i = textured[m][k];
      const TextureMap& map = *texture_map_on(scene, scene.polygons[mesh.polygon[i]], mesh.side[i]);
      const PatchCorners corners = mesh.corner_points(i);
      std::array<Eigen::Vector2d, 4> places;
      for (std::size_t c = 0; c < 4; ++c) places[c] = map.linear * corners.points[c] + map.offset;
      const auto count = static_cast<std::size_t>(corners.count);
      reflectance.row(i) = reflectance_of(surface, means.over(std::span(places).first(count)));
    });
  }
  return reflectance;
}

RadiosityProblem problem_of(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                            bool emit_from_back, Reflections reflections) {
  const Eigen::Index bands = number_of_bands(scene);
  const SurfaceOptics specular(scene, reflections);
  RadiosityProblem problem{{Field(mesh.size(), bands)}, Field::Zero(mesh.size(), bands), exposed_area};
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    problem.scattering.reflectance.row(i) = scene.materials[mesh.material[i]].reflectance;
  problem.scattering.reflectance = with_textures(std::move(problem.scattering.reflectance), scene, mesh);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Material& material = scene.materials[mesh.material[i]];
    const bool is_a_front = mesh.side[i] == Side::front || scene.polygons[mesh.polygon[i]].back_material.has_value();
    if (is_a_front || emit_from_back) problem.exitance.row(i) = material.exitance;
    const double nonspecular = specular.nonspecular_fraction(mesh.polygon[i], mesh.side[i]);
    problem.scattering.reflectance.row(i) = (problem.scattering.reflectance.row(i) / nonspecular).min(1.0);
    problem.exitance.row(i) /= nonspecular;
  }
  problem.scattering = with_sheets(std::move(problem.scattering), scene, mesh, exposed_area);
  return problem;
}

Scattering with_sheets(Scattering scattering, const Scene& scene, const PatchMesh& mesh,
                       const Eigen::VectorXd& exposed_area) {
  scattering.other_side = other_sides(mesh);
  if (scattering.is_diagonal()) return scattering;
  scattering.transmittance = Field::Zero(mesh.size(), scattering.reflectance.cols());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const PatchIndex j = scattering.other_side[i];
    if (j == i || !(exposed_area[i] > 0)) continue;
    const Spectrum& tau = scene.materials[scene.polygons[mesh.polygon[i]].material].diffuse_transmittance;
    scattering.transmittance.row(i) = tau * (std::min(exposed_area[i], exposed_area[j]) / exposed_area[i]);
  }
  return scattering;
}

Simulation to_geometric_area(Simulation simulation, const Scene& scene) {
  return of_other_parts(std::move(simulation), scene, true);
}

Simulation to_effective_area(Simulation simulation, const Scene& scene) {
  return of_other_parts(std::move(simulation), scene, false);
}

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

LitProblem lit_problem(const Run& run, const Plan& plan, const PatchMesh& mesh, const Eigen::VectorXd& exposed_area,
                       const Known& known) {
  LitProblem lit{problem_of(run.scene, mesh, exposed_area, plan.sides.emit_from_back, reflections_of(plan)), {}};
  if (!has_point_or_daylight(run.scene)) return lit;
  DirectIrradiance direct = direct_irradiance_beside(known, run, plan, mesh, lighting_options(plan, mesh));
  lit.problem.direct_irradiance = std::move(direct.irradiance);
  lit.direct_standard_error = std::move(direct.standard_error);
  lit.unfollowed = std::move(direct.unfollowed);
  lit.doublings = known.more_rays.to_lights;
  return lit;
}

DirectIrradiance over_exposed_part(DirectIrradiance direct, const PatchMesh& mesh, const LostShare& lost,
                                   const Eigen::VectorXd& exposed_area, std::span<const std::uint8_t> doublings) {
  if (direct.irradiance.size() == 0) return direct;
  const Eigen::ArrayXd factor = over_exposed_part(mesh, lost, exposed_area);
  for (Field* const field : {&direct.irradiance, &direct.standard_error, &direct.unfollowed})
    field->colwise() *= factor;
  for (Field* const error : {&direct.standard_error, &direct.unfollowed})
    *error = with_errors_around(mesh, exposed_area, *error, doublings);
  return direct;
}

LitProblem over_exposed_part(LitProblem lit, const PatchMesh& mesh, const LostShare& lost) {
  RadiosityProblem& problem = lit.problem;
  DirectIrradiance direct{std::move(problem.direct_irradiance), std::move(lit.direct_standard_error),
                          std::move(lit.unfollowed)};
  direct = over_exposed_part(std::move(direct), mesh, lost, problem.area, lit.doublings);
  problem.direct_irradiance = std::move(direct.irradiance);
  lit.direct_standard_error = std::move(direct.standard_error);
  lit.unfollowed = std::move(direct.unfollowed);
  return lit;
}

Field rough_direct_irradiance(const Run& run, const Plan& plan, const PatchMesh& quarters, std::uint64_t seed,
                              int rays) {
  const int to_lights = std::clamp(rays, 2, 8);
  const LightingOptions few{.luminaire_samples = to_lights,
                            .sun_samples = to_lights,
                            .mirrored_samples = std::clamp(rays / 2, 2, 8),
                            .sky_samples = std::clamp(4 * rays, 16, 64),
                            .seed = seed,
                            .alike = 4};
  return direct_irradiance_as_planned(run, plan, quarters, few).irradiance;
}

}  // namespace patchlight
