#include "archive/read_solution.h"

#include "patchlight/base/error.h"

#include "archive/scene_hash.h"
#include "base/tolerances.h"
#include "output/vtk/read_vtk.h"
#include "pipeline/problem_of.h"
#include "pipeline/world.h"
#include "scene/extent.h"
#include "scene/solids.h"
#include "visibility/flat_polygon.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace patchlight {
namespace {

[[noreturn]] void refuse_solution(const std::filesystem::path& file, const std::string& found) {
  throw InputError(file.string(), found + "; expected a solution as patchlight has written it: solve the scene again");
}

// Each index is that of a vertex or polygon, and patches follow the order of the scene's polygons, front before back.
void require_indices(const StoredSolution& stored, const Scene& scene, const std::filesystem::path& file) {
  const auto is_known = [&](std::uint32_t vertex) { return vertex < stored.vertices.size(); };
  bool sound = true;
  for (std::size_t k = 0; k < stored.corners.size(); ++k) {
    sound = sound && stored.polygon[k] < scene.polygons.size() &&
            std::all_of(stored.corners[k].begin(), stored.corners[k].end(), is_known);
    if (k > 0)
      sound =
          sound && std::pair(stored.polygon[k - 1], stored.side[k - 1]) <= std::pair(stored.polygon[k], stored.side[k]);
  }
  for (const Middle& middle : stored.middles)
    sound = sound && is_known(middle.vertex) && is_known(middle.ends[0]) && is_known(middle.ends[1]);
  if (!sound) refuse_solution(file, "its patches do not fit the scene");
}

void require_values(const StoredSolution& stored, Eigen::Index bands, const std::filesystem::path& file) {
  for (const Field* field : {&stored.radiosity, &stored.exitance, &stored.reflectance})
    if (field->cols() != bands) refuse_solution(file, "its bands are not those of the scene");
  const auto lie_between_0_and = [](const Field& field, double most) {
    return (field >= 0).all() && (field <= most).all();  // false for numbers that are not finite
  };
  constexpr double largest = std::numeric_limits<float>::max();
  if (!lie_between_0_and(stored.radiosity, largest) || !lie_between_0_and(stored.exitance, largest))
    refuse_solution(file, "its radiosities are not finite, or negative");
  if (!lie_between_0_and(stored.reflectance, 1)) refuse_solution(file, "its reflectances do not lie between 0 and 1");
}

// Patches lie within the box of their polygon, and together they are no larger than it. Polygons are plane up to 1e-4
// of their perimeter.
void require_places(const PatchMesh& mesh, const Scene& scene, const std::filesystem::path& file) {
  constexpr double planarity = 1e-4;
  const double extent = extent_of(scene);
  for (std::size_t slot = 0; slot + 1 < mesh.first_patch.size(); ++slot) {
    const std::vector<Point> corners = corner_points(scene, static_cast<PolygonIndex>(slot / 2));
    Box box;
    double perimeter = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      box.extend(corners[k]);
      perimeter += (corners[(k + 1) % corners.size()] - corners[k]).norm();
    }
    const double length = tolerance_of_coordinates * extent + planarity * perimeter;
    double area = 0;
    for (PatchIndex patch = mesh.first_patch[slot]; patch < mesh.first_patch[slot + 1]; ++patch) {
      bool sound = mesh.area[patch] > 0;
      for (const std::uint32_t vertex : mesh.corners[patch])
        sound = sound && box.exteriorDistance(mesh.vertices[vertex]) <= length;
      if (!sound) refuse_solution(file, "a patch does not lie in its polygon, or has no area");
      area += mesh.area[patch];
    }
    if (area > area_vector(corners).norm() * (1 + planarity) + tolerance_of_coordinates * extent * perimeter)
      refuse_solution(file, "the patches of a polygon are larger than it");
  }
}

bool has_patches(const PatchMesh& mesh, PolygonIndex polygon, Side side) {
  const PatchRange range = mesh.patches_on(polygon, side);
  return range.begin != range.end;
}

PatchMesh mesh_of(StoredSolution& stored, const Scene& scene) {
  PatchMesh mesh;
  mesh.vertices = std::move(stored.vertices);
  mesh.corners = std::move(stored.corners);
  mesh.polygon = std::move(stored.polygon);
  mesh.side = std::move(stored.side);
  mesh.middles = std::move(stored.middles);
  mesh.area.resize(mesh.corners.size());
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const PolygonIndex polygon = mesh.polygon[patch];
    const Side side = mesh.side[patch];
    const PatchCorners corners = mesh.corner_points(patch);
    mesh.normal.emplace_back((side == Side::front ? 1 : -1) * front_normal(scene, polygon));
    mesh.centroid.push_back(area_centroid(corners));
    mesh.area[patch] = mesh.normal.back().dot(area_vector(corners));
    mesh.material.push_back(material_on(scene.polygons[polygon], side));
  }
  PatchIndex next = 0;
  for (std::size_t slot = 0; slot < 2 * scene.polygons.size(); ++slot) {
    mesh.first_patch.push_back(next);
    while (next < mesh.size() &&
           2 * std::size_t{mesh.polygon[next]} + static_cast<std::size_t>(mesh.side[next]) == slot)
      ++next;
  }
  mesh.first_patch.push_back(next);
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    if (is_sheet(scene, polygon) && has_patches(mesh, polygon, Side::front) && has_patches(mesh, polygon, Side::back))
      mesh.sheets.push_back(polygon);
  }
  return mesh;
}

// Those that have patches.
KeptSides sides_of(const PatchMesh& mesh, const Scene& scene) {
  KeptSides sides;
  for (PolygonIndex polygon = 0; polygon < scene.polygons.size(); ++polygon) {
    sides.front.push_back(has_patches(mesh, polygon, Side::front) ? 1 : 0);
    sides.back.push_back(has_patches(mesh, polygon, Side::back) ? 1 : 0);
  }
  sides.geometry = geometry_of(scene, sides);
  return sides;
}

}  // namespace

Simulation read_solution(const std::filesystem::path& file, std::shared_ptr<const Scene> read) {
  const Scene& scene = *read;
  StoredSolution stored = read_vtk(file);
  if (stored.scene_hash != scene_hash(scene)) {
    throw InputError(file.string(),
                     "this is the solution of another scene: faces, materials or lights differ\n"
                     "hint: give the models and model options of the solution, or solve again");
  }
  require_indices(stored, scene, file);
  require_values(stored, number_of_bands(scene), file);
  Simulation simulation;
  simulation.mesh = mesh_of(stored, scene);
  const PatchMesh& mesh = simulation.mesh;
  require_places(mesh, scene, file);
  Plan& plan = simulation.plan;
  plan.sides = sides_of(mesh, scene);
  plan.decisions = std::move(stored.decisions);
  plan.assembly.seed = stored.seed;
  if (stored.follows_reflections) plan.assembly.storage = Storage::rays;
  plan.coverings = std::make_shared<const Coverings>(find_coverings(scene, plan.sides));
  simulation.world = std::make_shared<const World>(std::move(read), plan);
  RadiosityProblem& problem = simulation.problem;
  problem.area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  problem.exitance = std::move(stored.exitance);
  problem.scattering.reflectance = std::move(stored.reflectance);
  if (!mesh.sheets.empty())
    problem.scattering =
        with_sheets(std::move(problem.scattering), simulation.world->planned_scene(), mesh, problem.area);
  simulation.solution.radiosity = std::move(stored.radiosity);
  simulation.solution.converged = stored.converged;
  return simulation;
}

}  // namespace patchlight
