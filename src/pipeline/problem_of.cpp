#include "pipeline/problem_of.h"

#include "base/parallel.h"
#include "light/texture.h"
#include "mesh/nested_mesh.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <utility>
#include <vector>

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
  const SpecularFaces specular(scene, reflections);
  RadiosityProblem problem{{Field(mesh.size(), bands)}, Field::Zero(mesh.size(), bands), exposed_area};
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    problem.scattering.reflectance.row(i) = scene.materials[mesh.material[i]].reflectance;
  problem.scattering.reflectance = with_textures(std::move(problem.scattering.reflectance), scene, mesh);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Material& material = scene.materials[mesh.material[i]];
    const bool is_a_front = mesh.side[i] == Side::front || scene.polygons[mesh.polygon[i]].back_material.has_value();
    if (is_a_front || emit_from_back) problem.exitance.row(i) = material.exitance;
    const double held = specular.held(mesh.polygon[i], mesh.side[i]);
    problem.scattering.reflectance.row(i) = (problem.scattering.reflectance.row(i) / held).min(1.0);
    problem.exitance.row(i) /= held;
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

namespace {

// What patches hold of light from all directions alike.
Eigen::ArrayXd held_shares_of(const Simulation& simulation, const Scene& scene) {
  const SpecularFaces specular(scene, reflections_of(simulation.plan));
  const PatchMesh& mesh = simulation.mesh;
  Eigen::ArrayXd held(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) held[i] = specular.held(mesh.polygon[i], mesh.side[i]);
  return held;
}

// From areas a to areas a / factor, with B, E and rho times the factor: the same flux.
Simulation of_other_parts(Simulation simulation, const Eigen::ArrayXd& factor) {
  RadiosityProblem& problem = simulation.problem;
  Solution& solution = simulation.solution;
  for (Eigen::Index i = 0; i < factor.size(); ++i) {
    if (factor[i] == 1) continue;
    problem.area[i] /= factor[i];
    for (Field* field : {&problem.scattering.reflectance, &problem.exitance, &solution.radiosity, &solution.error})
      if (field->rows() > 0) field->row(i) *= factor[i];
  }
  return simulation;
}

}  // namespace

Simulation of_whole_patches(Simulation simulation, const Scene& scene) {
  const Eigen::ArrayXd held = held_shares_of(simulation, scene);
  return of_other_parts(std::move(simulation), held);
}

Simulation of_held_parts(Simulation simulation, const Scene& scene) {
  const Eigen::ArrayXd held = held_shares_of(simulation, scene);
  return of_other_parts(std::move(simulation), 1 / held);
}

}  // namespace patchlight
