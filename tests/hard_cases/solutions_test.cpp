// Difficult systems: reflectances close to 1 or equal to 1, and isolated patches.
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "plan/survey.h"
#include "scene/repair.h"
#include "support/meshes.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>

namespace patchlight::solutions_test {
namespace {

using namespace test;

Request coarse(double tolerance, int max_iterations) {
  Request request;
  request.mesh.max_edge = 0.7501;
  request.solver.relative_error = tolerance;
  request.solver.max_iterations = max_iterations;
  return request;
}

// A closed 4 x 3 x 2.5 m room of one material with a box in it.
Scene uniform_room(double reflectance, double exitance) {
  Scene scene = with_box(empty_scene({grey(reflectance, exitance)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  return with_box(std::move(scene), Point(1, 1, 0.5), Point(2, 1.8, 1.2), false);
}

class Furnace : public testing::TestWithParam<double> {};

// E = 1 - rho in a closed room gives B = 1. The solver bounds ||B - B_k|| / ||B - E|| by 1e-10 in the area norm. Row
// sums are exact to d = 1e-10 of the area: (I - rho F) 1 = 1 - rho (1 + d) gives |B - 1| <= rho d / (1 - rho) if all d
// have one sign. The residuals of CG do not, but 1e-8 holds up to rho = 0.99 even then.
TEST_P(Furnace, RadiosityIsOneToOneInAHundredMillion) {
  const double rho = GetParam();
  Request request = coarse(1e-10, 100'000);
  request.mesh.sides = Sides::front;
  const Simulation simulation = simulate(uniform_room(rho, 1 - rho), request);
  ASSERT_TRUE(simulation.solution.converged);
  EXPECT_EQ(simulation.transport.closure, "least squares");
  EXPECT_LT((simulation.solution.radiosity - 1).abs().maxCoeff(), 1e-8);
  EXPECT_LT(simulation.balance.imbalance, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Reflectances, Furnace, testing::Values(0.01, 0.5, 0.9, 0.99, 0.999));

// A lamp in a room of rho = 0.999: light is reflected a thousand times. All emitted flux is accounted for.
TEST(NearlyPerfectReflection, BalancesEnergyToABillionth) {
  Request request = coarse(1e-9, 100'000);
  const Simulation simulation = simulate(furnished_room(0.999, 10), request);
  ASSERT_TRUE(simulation.solution.converged);
  EXPECT_LT(simulation.balance.imbalance, 1e-9);
  // The room is closed: its black lamp and its walls absorb the emitted flux, up to the error of row sums.
  EXPECT_EQ(simulation.transport.closure, "least squares");
  EXPECT_NEAR(simulation.balance.absorbed[0], simulation.balance.emitted[0], 1e-8 * simulation.balance.emitted[0]);
}

// No surface absorbs light, so no solution exists. The survey reports it in advance, and the solver stops before the
// first iteration without a bound. It returns the light of the lamps alone.
TEST(PerfectReflection, InAClosedRoomHasNoAnswerAndIsSaidToHaveNone) {
  const Scene scene = uniform_room(1, 1);
  const Diagnostics problems = survey(scene).diagnostics;
  EXPECT_TRUE(std::any_of(problems.begin(), problems.end(),
                          [](const Diagnostic& problem) { return problem.code == DiagnosticCode::full_reflectance; }));
  for (const Solver solver : all_solvers()) {
    Request request = coarse(1e-6, 30);
    request.mesh.sides = Sides::front;
    request.solver.solver = solver;
    const Solution solution = simulate(scene, request).solution;
    EXPECT_FALSE(solution.converged);
    EXPECT_EQ(solution.history.size(), 1U);
    EXPECT_FALSE(solution.trapped.empty());
    EXPECT_EQ(solution.history.back().error_bound, std::numeric_limits<double>::infinity());
    EXPECT_TRUE((solution.radiosity == 1).all());
  }
}

// The Cornell box with white at Kd = 1, as in some files, is open. Light leaves, and the red and green walls absorb, so
// a solution exists. The balance closes to the tolerance.
TEST(PerfectReflection, InTheOpenCornellBoxIsSolvedAndWarnedOf) {
  const ReadOptions white{.settings = {parse_material_setting("white.reflectance=1")}};
  const Scene scene = repair(read_scene(mesh_folder() / "cornell_box.obj", white));
  const Diagnostics problems = survey(scene).diagnostics;
  EXPECT_TRUE(std::any_of(problems.begin(), problems.end(),
                          [](const Diagnostic& problem) { return problem.code == DiagnosticCode::full_reflectance; }));
  Request request;
  request.mesh.patches = 500;
  request.solver.relative_error = 1e-8;
  for (const Solver solver : all_solvers()) {
    request.solver.solver = solver;
    const Simulation simulation = simulate(scene, request);
    ASSERT_TRUE(simulation.solution.converged) << name_of(solver);
    EXPECT_GT((simulation.balance.escaped / simulation.balance.emitted).minCoeff(), 0.1);
    // The remainder is sum_i A_i sum_j F_ij r_i, at most sqrt(A) ||r||_A. For rho = 1 the bound of every patch stops
    // the solver: ||v||_A max |r_j| / g_j <= 1e-8 ||B - E||_A, with v >= 1 and g <= 1.5, so ||r||_A <= 1.5e-8 ||B -
    // E||_A.
    const double area = simulation.problem.area.sum();
    const Eigen::ArrayXd reflected =
        area_norm(simulation.solution.radiosity - simulation.problem.exitance, simulation.problem.area);
    const double most = 1.5e-8 * (std::sqrt(area) * reflected / simulation.balance.emitted).maxCoeff();
    EXPECT_LT(simulation.balance.imbalance, most);
  }
}

// Two white boards 0.4 mm apart in a room: light needs hundreds of bounces to leave the gap. Rays simulate this light
// separately, so the solver has a finite bound. The bound holds against a solution with a hundredth of the tolerance.
TEST(PerfectReflection, BetweenBoardsCloseToEachOtherIsSolvedWithABound) {
  Scene scene = empty_scene({grey(0.5), grey(0.5, 10), grey(1)});
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(2, 2, 2), true);
  scene = with_quad(std::move(scene),
                    {Point(0.7, 0.7, 1.9), Point(0.7, 1.3, 1.9), Point(1.3, 1.3, 1.9), Point(1.3, 0.7, 1.9)}, 1);
  for (const double z : {0.5, 0.5004})
    scene = with_quad(std::move(scene),
                      {Point(0.7, 0.7, z), Point(1.2, 0.7, z), Point(1.2, 1.2, z), Point(0.7, 1.2, z)}, 2);
  Request request;
  request.mesh.patches = 4000;
  request.mesh.sides = Sides::both;
  request.accuracy.error_bars = false;
  request.assembly.storage = Storage::rays;
  request.solver = {.solver = Solver::gmres, .relative_error = 1e-3};
  const Simulation loose = simulate(scene, request);
  ASSERT_TRUE(loose.solution.converged);
  ASSERT_LE(loose.solution.patch_bound, 1e-3);
  request.solver.relative_error = 1e-5;
  const Simulation tight = simulate(scene, request);
  const Field off = (loose.solution.radiosity - tight.solution.radiosity).abs();
  // Smoothing is linear except for the light that it excludes. The separately simulated light is exact to a hundredth
  // of the tolerance.
  EXPECT_LE((off - 1.1 * loose.solution.error).maxCoeff(), 1e-5 * tight.solution.radiosity.maxCoeff());
}

// A single lamp, two lamps back to back, or two coplanar lamps: B = E to the bit, without iterations.
TEST(IsolatedPatches, KeepTheirExitance) {
  const Quad square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  const Quad behind{Point(0, 0, -1), Point(0, 1, -1), Point(1, 1, -1), Point(1, 0, -1)};
  const Quad beside{Point(2, 0, 0), Point(3, 0, 0), Point(3, 1, 0), Point(2, 1, 0)};
  const Scene alone = with_quad(empty_scene({grey(0.5, 3)}), square);
  for (const Scene& scene : {alone, with_quad(alone, behind), with_quad(alone, beside)}) {
    Request request = coarse(1e-6, 100);
    request.mesh.sides = Sides::front;
    const Simulation simulation = simulate(scene, request);
    EXPECT_TRUE(simulation.solution.converged);
    EXPECT_EQ(simulation.solution.history.size(), 1U);
    EXPECT_TRUE((simulation.solution.radiosity == 3).all());
    EXPECT_TRUE((simulation.solution.irradiance == 0).all());
    EXPECT_DOUBLE_EQ(simulation.balance.escaped[0], simulation.balance.emitted[0]);
  }
}

// The same next to a lit room: a lamp outside that faces away from it.
TEST(IsolatedPatches, KeepTheirExitanceBesideALitRoom) {
  Scene scene = furnished_room(0.6);
  const auto lamp = static_cast<PolygonIndex>(scene.polygons.size());
  scene.materials.push_back(grey(0.7, 5));
  scene = with_quad(std::move(scene), {Point(9, 0, 0), Point(9, 1, 0), Point(9, 1, 1), Point(9, 0, 1)}, 2);
  Request request = coarse(1e-6, 100);
  request.mesh.sides = Sides::front;
  const Simulation simulation = simulate(scene, request);
  EXPECT_TRUE(simulation.solution.converged);
  const PatchRange patches = simulation.mesh.patches_on(lamp, Side::front);
  ASSERT_LT(patches.begin, patches.end);
  for (PatchIndex i = patches.begin; i < patches.end; ++i) {
    EXPECT_EQ(simulation.solution.radiosity(i, 0), 5);
    EXPECT_EQ(simulation.solution.irradiance(i, 0), 0);
  }
}

}  // namespace
}  // namespace patchlight::solutions_test
