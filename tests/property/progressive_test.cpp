// The early results of progressive refinement with rows on demand.
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "support/meshes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::progressive_test {
namespace {

// ||B_ref - B||_A / ||B_ref - E||_A, worst band.
double error_of(const Field& radiosity, const Simulation& reference) {
  const RadiosityProblem& problem = reference.problem;
  const Field& exact = reference.solution.radiosity;
  return (area_norm(exact - radiosity, problem.area) / area_norm(exact - problem.exitance, problem.area)).maxCoeff();
}

// The remaining error after adding the best constant irradiance.
double least_error_with_even_light(const Field& radiosity, const Simulation& reference) {
  const RadiosityProblem& problem = reference.problem;
  // For B + c rho the sum of squares is least with c = <rho, B_ref - B> / <rho, rho>.
  const Field missing = reference.solution.radiosity - radiosity;
  const Field weighted = problem.scattering.reflectance.colwise() * problem.area.array();
  const Field c = (weighted * missing).colwise().sum() / (weighted * problem.scattering.reflectance).colwise().sum();
  return error_of(radiosity + problem.scattering.reflectance.rowwise() * c.row(0), reference);
}

// A twentieth of the rows gives an error below 20 %, enough for a first picture. The Cornell box has few lamps and an
// open side, and half of its reflected light is unshot at that time. No constant irradiance gets the error below 20 %,
// so the ambient term of Cohen et al. 1988 would fail. With fewer than 2,000 patches, the lamps and one row of every
// group would already be a twentieth. The inner sides of the blocks are included although they are dark. Without them
// the lit patches are finer, and the best constant irradiance gets to 17 %.
TEST(ProgressiveRefinement, ShowsTheCornellBoxAfterATwentiethOfTheRows) {
  const Scene scene = read_scene(mesh_folder() / "cornell_box.obj");
  Request request;
  request.mesh.patches = 2000;
  request.effects.force = {Effect::reach};
  const Simulation reference = simulate(scene, request);
  ASSERT_TRUE(reference.solution.converged);
  request.assembly.storage = Storage::on_demand;
  request.solver.max_rows = 0.05;
  for (const Solver solver : {Solver::progressive, Solver::overshooting}) {
    request.solver.solver = solver;
    const Simulation early = simulate(scene, request);
    EXPECT_FALSE(early.solution.converged);
    EXPECT_LE(early.solution.history.back().work, 0.05);
    const Field shown = early.solution.radiosity + early.problem.scattering.reflectance * early.solution.ambient;
    EXPECT_LT(error_of(shown, reference), 0.2) << name_of(solver);
    EXPECT_GT(least_error_with_even_light(early.solution.radiosity, reference), 0.2) << name_of(solver);
  }
}

}  // namespace
}  // namespace patchlight::progressive_test
