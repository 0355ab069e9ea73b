#include "patchlight/solve/solve.h"
#include "patchlight/transport/assemble.h"

#include "mesh/interpolate.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "pipeline/problem_of.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::test {
namespace {

struct Solved {
  PatchMesh mesh;
  RadiosityProblem problem;
  Field radiosity;
};

// Three unit squares that face each other without touching. The upper one is a lamp, so the light is smooth.
Scene three_squares() {
  Scene scene = empty_scene({grey(0.5), grey(0.5, 10)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)}, 1);
  return with_quad(std::move(scene), {Point(1.5, 0, 0), Point(1.5, 0, 1), Point(1.5, 1, 1), Point(1.5, 1, 0)});
}

Solved solved_on(const Scene& scene, PatchMesh mesh) {
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  Assembly raw = assemble_exchange_areas(mesh, Occluder(scene));
  const auto transport = dense_transport(keep_exchange_areas(std::move(raw.exchange_areas), "open"), area);
  RadiosityProblem problem = problem_of(scene, mesh, area, false);
  Field radiosity = solve(*transport, problem, {.relative_error = 1e-8}).radiosity;
  return {std::move(mesh), std::move(problem), std::move(radiosity)};
}

// Each mesh cuts every patch of the previous one into four.
std::vector<Solved> solved_on_nested_meshes(const Scene& scene, int meshes) {
  constexpr double half = 0.5 + 1e-9;
  PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), half);
  std::vector<Solved> all;
  for (int k = 0; k < meshes; ++k) {
    all.push_back(solved_on(scene, mesh));
    mesh = refine(mesh);
  }
  return all;
}

double error_of_means(const Solved& solved, const Solved& reference) {
  return relative_error(average_over(solved.mesh, reference.mesh, reference.radiosity), solved.radiosity,
                        solved.problem);
}

double error_of_constants(const Solved& solved, const Solved& reference) {
  return relative_error(reference.radiosity, average_over(reference.mesh, solved.mesh, solved.radiosity),
                        reference.problem);
}

// A closed unit cube with a bright floor and this number of parts along each edge.
Solved solved_cube(int parts, bool graded_edges) {
  Scene scene = cube_room(0.5, 0);
  scene.materials.push_back(grey(0.5, 1));
  scene.polygons[0].material = 1;
  const double max_edge = (1 + 1e-9) / parts;
  return solved_on(scene, tessellate(scene, kept_sides(scene, Sides::front), max_edge, {}, graded_edges));
}

// The order of convergence of patch means, from meshes of 8 and 16 parts against one of 32. The points of each mesh are
// points of the next.
double order_in_cube(bool graded_edges) {
  const Solved reference = solved_cube(32, graded_edges);
  return std::log2(error_of_means(solved_cube(8, graded_edges), reference) /
                   error_of_means(solved_cube(16, graded_edges), reference));
}

}  // namespace

// Without shadow edges, patch means converge with order 2, like the midpoint rule, and a field that is constant on each
// patch with order 1. The references are 16 and 64 times finer; their own errors would raise the orders by less than
// 0.1.
TEST(Orders, PatchMeansConvergeFasterThanTheConstantField) {
  const std::vector<Solved> all = solved_on_nested_meshes(three_squares(), 5);
  const Solved& reference = all[4];
  const double of_means = std::log2(error_of_means(all[1], reference) / error_of_means(all[2], reference));
  const double of_constants = std::log2(error_of_constants(all[1], reference) / error_of_constants(all[2], reference));
  EXPECT_GE(of_means, 1.5);
  EXPECT_LE(of_means, 2.3);
  EXPECT_GE(of_constants, 0.9);
  EXPECT_LE(of_constants, 1.3);
}

// At edges between lit walls the light has no derivatives. Uniform patches lose half an order or more: 1.26 instead of
// 2 at reflectance 0.5; graded patches lose none (docs/theory/edges-and-contacts.md). The reference is twice as fine as
// the finer mesh, which adds about the same to both.
TEST(Orders, GradedEdgesRestoreTheOrderWhereLitWallsMeet) {
  const double graded = order_in_cube(true);
  EXPECT_GE(graded, 1.8);
  EXPECT_GE(graded, order_in_cube(false) + 0.4);
}

}  // namespace patchlight::test
