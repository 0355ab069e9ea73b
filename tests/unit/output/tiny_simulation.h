#pragma once

#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "pipeline/world.h"

#include <limits>

namespace patchlight {

/// Two materials, three polygons: a unit square and two triangles above two of its edges.
inline Scene tiny_scene() {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 2}};
  scene.polygons = {{{0, 1, 2, 3}, 0}, {{1, 0, 4}, 1}, {{2, 1, 4}, 1}};
  for (PolygonIndex p = 0; p < 3; ++p) scene.polygons[p].face = 10 + p;
  scene.materials = {{"floor", rgb(0.5, 0.25, 0.125), rgb(0, 0, 0)}, {"lamp", rgb(0.1, 0.2, 0.3), rgb(8, 4, 2)}};
  scene.file = "tiny.obj";
  scene.sha256 = "00ff";
  scene.diagnostics = {{DiagnosticCode::simplified_part, "a note"}};
  return scene;
}

/// A simulation of it with invented irradiances and B = E + rho o H, without a solver.
inline Simulation tiny_simulation() {
  const Scene scene = tiny_scene();
  Simulation simulation;
  PatchMesh& mesh = simulation.mesh;
  mesh.vertices = scene.vertices;
  mesh.corners = {{0, 1, 2, 3}, {1, 0, 4, 4}, {2, 1, 4, 4}};
  mesh.polygon = {0, 1, 2};
  mesh.material = {0, 1, 1};
  mesh.side.assign(3, Side::front);
  mesh.first_patch = {0, 1, 1, 2, 2, 3, 3};
  for (PolygonIndex p = 0; p < 3; ++p) {
    const std::vector<Point> points = corner_points(scene, p);
    mesh.centroid.push_back(area_centroid(points));
    mesh.normal.push_back(front_normal(scene, p));
    mesh.area.push_back(area_vector(points).norm());
  }

  RadiosityProblem& problem = simulation.problem;
  problem.area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), 3);
  problem.scattering.reflectance.resize(3, 3);
  problem.exitance.resize(3, 3);
  for (PatchIndex i = 0; i < 3; ++i) {
    problem.scattering.reflectance.row(i) = scene.materials[mesh.material[i]].reflectance;
    problem.exitance.row(i) = scene.materials[mesh.material[i]].exitance;
  }
  Solution& solution = simulation.solution;
  solution.irradiance.resize(3, 3);
  solution.irradiance << 1, 2, 3, 0.1, 0.7, 5, 1e-3, 40, 6;
  solution.direct_irradiance = 0.25 * solution.irradiance;
  solution.radiosity = problem.exitance + problem.scattering.reflectance * solution.irradiance;
  solution.history = {{0, 1, std::numeric_limits<double>::infinity(), 0, 1}, {1, 1e-7, 2e-7, 0.25, 2}};
  solution.converged = true;

  TransportFacts& transport = simulation.transport;
  transport.raw_row_sum = Eigen::Vector3d(0.5, 0.75, 0.25);
  transport.row_sum = Eigen::Vector3d(0.5, 0.5, 0.5);
  transport.lost = {Eigen::Vector3d(0.5, 0.25, 0.5), Eigen::Vector3d(0, 0.25, 0), Eigen::Vector3d(0, 0, 0.5), 64};
  transport.closure = "scaling";
  const Eigen::Array3d flux(1, 2, 3);
  simulation.balance = {flux, 2 * flux, flux, flux, flux, flux, 1e-7};
  simulation.plan.assembly.seed = (std::uint64_t{1} << 60) + 1;
  simulation.plan.decisions = {{Effect::occlusion, false, "a reason", "a saving", true}};
  simulation.world = std::make_shared<const World>(std::make_shared<const Scene>(scene), simulation.plan);
  simulation.costs = {{Stage::mesh, 0.5, 1}, {Stage::solve, 0.25, 0.5}};
  return simulation;
}

/// The same simulation in another scene.
inline Simulation in_scene(Simulation simulation, const Scene& scene) {
  simulation.world = std::make_shared<const World>(std::make_shared<const Scene>(scene), simulation.plan);
  return simulation;
}

/// Its surface.
inline SolvedSurface tiny_surface() {
  static const Simulation simulation = tiny_simulation();
  return surface_of(simulation);
}

/// The same simulation with invented error bars on the irradiance.
inline Simulation tiny_simulation_with_bars() {
  Simulation simulation = tiny_simulation();
  const Field& H = simulation.solution.irradiance;
  simulation.error_bars = {
      .mesh = 0.03 * H, .mesh_noise = {}, .form_factor = 0.02 * H, .solver = 0.0625 * H.sqrt(), .display = 0.5 * H};
  simulation.accuracy = {{.patches = 2, .new_patches = 2, .samples = 16, .mesh = 0.5, .total = 0.5},
                         {.patches = 3,
                          .new_patches = 1,
                          .samples = 32,
                          .mesh = 0.03,
                          .form_factor = 0.04,
                          .solver = 0.001,
                          .total = 0.05,
                          .display = 0.25,
                          .seconds = 2,
                          .cpu_seconds = 4}};
  return simulation;
}

}  // namespace patchlight
