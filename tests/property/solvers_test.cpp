// Laws of the solvers, on real rooms.
#include "patchlight/input/read_scene.h"
#include "patchlight/solve/solve.h"

#include "solve/bounds.h"
#include "support/assembled.h"
#include "support/direct_solution.h"
#include "support/meshes.h"
#include "support/scenes.h"
#include "support/test_room.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::solvers_test {
namespace {

using namespace test;

// Two rooms with a door in the wall without thickness between them, and a lamp in one.
Scene two_small_rooms(double reflectance) {
  Scene scene = with_box(empty_scene({grey(reflectance), grey(0, 10)}), Point(0, 0, 0), Point(4, 2, 2), true);
  scene = with_polygon(std::move(scene), {Point(2, 0, 0), Point(2, 0.7, 0), Point(2, 0.7, 1.5), Point(2, 1.3, 1.5),
                                          Point(2, 1.3, 0), Point(2, 2, 0), Point(2, 2, 2), Point(2, 0, 2)});
  return with_quad(std::move(scene),
                   {Point(0.7, 0.7, 1.8), Point(0.7, 1.3, 1.8), Point(1.3, 1.3, 1.8), Point(1.3, 0.7, 1.8)}, 1);
}

Scene open_room(double reflectance) {
  Scene scene = furnished_room(reflectance);
  scene.polygons.erase(scene.polygons.begin() + 1);
  return scene;
}

// A room to solve, and the accuracy.
struct Case {
  std::string name;
  Assembled room;
  double relative_error = 1e-8;
};

// Two bands of different reflectances and lamps, so that neither is a copy of the other.
Assembled in_two_bands(Assembled room, double second_reflectance) {
  const RadiosityProblem grey = room.problem;
  Field reflectance(grey.scattering.reflectance.rows(), 2);
  Field exitance = Field::Zero(grey.scattering.reflectance.rows(), 2);
  reflectance << grey.scattering.reflectance, (grey.scattering.reflectance > 0).cast<double>() * second_reflectance;
  exitance.col(0) = grey.exitance.col(0);
  exitance(0, 1) = 3;
  room.problem = {{reflectance}, exitance, grey.area};
  return room;
}

// About 300 patches each, as some solvers need thousands of iterations.
std::vector<Case> five_scenes() {
  std::vector<Case> cases;
  cases.push_back({"closed", in_two_bands(assembled(furnished_room(0.7), 0.5), 0.3)});
  cases.push_back({"open", in_two_bands(assembled(open_room(0.7), 0.6), 1)});
  cases.push_back({"two rooms", in_two_bands(assembled(two_small_rooms(0.8), 0.5), 0.5)});
  cases.push_back({"reflectance 0.999", assembled(test_room(0.999), 1.2), 1e-4});
  cases.push_back({"reflectance 0", assembled(furnished_room(0), 0.5)});
  return cases;
}

class EverySolver : public testing::TestWithParam<Solver> {};

TEST_P(EverySolver, AgreesWithADenseSolveInFiveScenes) {
  for (const auto& [name, room, relative_error] : five_scenes()) {
    SCOPED_TRACE(name);
    ASSERT_EQ(room.closed, name != "open");
    const Solution solution = solve(*room.transport, room.problem,
                                    {.solver = GetParam(), .relative_error = relative_error, .max_iterations = 100000});
    ASSERT_TRUE(solution.converged);
    const Field exact = direct_solution(*room.transport, room.problem);
    const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, room.problem.area);
    const Eigen::ArrayXd reflected = area_norm(exact - room.problem.exitance, room.problem.area);
    // The bound is relative to the reflected light of the iterate, which the tolerance keeps close to the exact one.
    // The last term allows for rounding of values up to 10.
    EXPECT_TRUE((error <= (1 + 2 * relative_error) * relative_error * reflected + 1e-13).all()) << error.transpose();
    // H = F B, even if nothing is reflected.
    const Field arrived = room.transport->apply(exact);
    const Eigen::ArrayXd missing = area_norm(arrived - solution.irradiance, room.problem.area);
    EXPECT_TRUE((missing <= 3 * relative_error * area_norm(arrived, room.problem.area)).all()) << missing.transpose();
  }
}

// Law: in a closed room where every patch emits the fraction that it absorbs, E = 1 - rho, B = 1 everywhere.
TEST_P(EverySolver, FindsTheFurnace) {
  Assembled room = assembled(furnished_room(0.5), 0.5);
  ASSERT_TRUE(room.closed);
  const Eigen::Index n = room.problem.scattering.reflectance.rows();
  Field mixed(n, 1);
  // From 0 to 1: some patches emit nothing.
  for (Eigen::Index i = 0; i < n; ++i) mixed(i, 0) = 0.1 * static_cast<double>(i % 11);
  std::vector<Field> reflectances{mixed};
  for (const double uniform : {0.0, 0.3, 0.9}) reflectances.push_back(Field::Constant(n, 1, uniform));
  for (const Field& reflectance : reflectances) {
    room.problem.scattering.reflectance = reflectance;
    room.problem.exitance = 1 - reflectance;
    // A patch's error is at most sqrt(sum A / A_i) times that of the norm: less than 100 times.
    const Solution solution =
        solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-10, .max_iterations = 10000});
    ASSERT_TRUE(solution.converged);
    EXPECT_LT((solution.radiosity - 1).abs().maxCoeff(), 1e-8) << reflectance(1, 0);
    EXPECT_LT((solution.irradiance - 1).abs().maxCoeff(), 1e-8) << reflectance(1, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver, testing::ValuesIn(all_solvers()), [](const auto& parameter) {
  std::string name = name_of(parameter.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// A reference solution with five digits more than the compared ones.
Field reference(const Assembled& room) {
  const Solution solution = solve(*room.transport, room.problem, {.relative_error = 1e-11});
  EXPECT_TRUE(solution.converged);
  return solution.radiosity;
}

// The largest eigenvalue, that of uniform light, is far above all others, so the number of applications hardly grows
// with the reflectance.
TEST(ConjugateGradients, NeedFewApplicationsForAnyReflectance) {
  Assembled room = assembled(test_room(0.5), test_room_edge);
  ASSERT_TRUE(room.closed);
  ASSERT_NEAR(room.mesh.size(), 2228, 50);
  for (const double reflectance : {0.5, 0.8, 0.95, 0.99, 0.999}) {
    room.problem.scattering.reflectance.setConstant(reflectance);
    const Field exact = reference(room);
    // The count includes the applications for row sums, direct light and the final residual.
    const Solution met = solve(*room.transport, room.problem, {.relative_error = 1e-6, .reference = exact});
    ASSERT_TRUE(met.converged);
    EXPECT_LE(met.history.back().work, 18) << reflectance;
    const Solution certified = solve(*room.transport, room.problem, {.relative_error = 1e-6});
    ASSERT_TRUE(certified.converged);
    EXPECT_LE(certified.history.back().work, 26) << reflectance;
    EXPECT_LE(certified.history.back().error_bound, 1e-6);
  }
}

// The errors of Jacobi are K^k (B* - E), so their ratio converges to the largest eigenvalue. The second one is about
// 0.7 of it, which 60 iterations reduce to 1e-9.
TEST(Jacobi, ConvergesAtTheSpectralRadius) {
  Assembled room = assembled(test_room(0.8), test_room_edge);
  // The floor and low surfaces are darker, so the mode is not constant, and its eigenvalue equals none of the
  // reflectances.
  for (PatchIndex i = 0; i < room.mesh.size(); ++i) {
    if (room.mesh.centroid[i].z() < 1) room.problem.scattering.reflectance(i, 0) = 0.3;
  }
  const Field exact = reference(room);
  const Solution solution =
      solve(*room.transport, room.problem, {.solver = Solver::jacobi, .relative_error = 1e-9, .reference = exact});
  ASSERT_TRUE(solution.converged);
  const auto& last = solution.history.back();
  const auto& before = solution.history[solution.history.size() - 2];
  const double radius = spectral_radius(*room.transport, room.problem, 20)[0];
  EXPECT_GT(radius, 0.35);
  EXPECT_LT(radius, 0.75);
  EXPECT_NEAR(last.true_error / before.true_error, radius, 0.02 * radius);
}

// For a constant mode of eigenvalue rho, in the limit of many equal patches, a sweep multiplies the error by lambda
// with ln lambda = rho (1 - 1 / lambda). For rho = 0.8, lambda = 0.650 and ln lambda / ln rho = 1.93, so 0.52 of
// Jacobi's iterations. The first iterations from the lamps are not yet at this rate.
TEST(GaussSeidel, NeedsAboutHalfOfJacobisIterations) {
  const Assembled room = assembled(test_room(0.8), test_room_edge);
  const Field exact = reference(room);
  const auto iterations = [&](Solver solver) {
    const Solution solution =
        solve(*room.transport, room.problem, {.solver = solver, .relative_error = 1e-6, .reference = exact});
    EXPECT_TRUE(solution.converged);
    return static_cast<double>(solution.history.back().number);
  };
  const double share = iterations(Solver::gauss_seidel) / iterations(Solver::jacobi);
  EXPECT_GT(share, 0.4);
  EXPECT_LT(share, 0.65);
}

// See docs/theory/solvers-and-bounds.md. From one factor of this grid to the next, the number of iterations changes by
// up to a third. The estimate, which lies between two of them, needs at most one iteration more than the best.
TEST(SuccessiveOverRelaxation, EstimatesABestFactor) {
  Assembled room = assembled(test_room(0.8), test_room_edge);
  for (const double reflectance : {0.5, 0.8, 0.95}) {
    room.problem.scattering.reflectance.setConstant(reflectance);
    const Field exact = reference(room);
    const auto iterations = [&](std::optional<double> factor) {
      const Solution solution =
          solve(*room.transport, room.problem,
                {.solver = Solver::sor, .relative_error = 1e-6, .relaxation = factor, .reference = exact});
      EXPECT_TRUE(solution.converged);
      return solution.history.back().number;
    };
    int best = iterations(1);
    EXPECT_GT(best, iterations({}));
    for (double factor = 1.1; factor < 1.85; factor += 0.1) best = std::min(best, iterations(factor));
    EXPECT_LE(iterations({}), best + 1) << reflectance;
  }
}

// Work to reach a true error of 1e-6, in applications.
double work(const Assembled& room, const RadiosityProblem& problem, Solver solver) {
  const Solution exact = solve(*room.transport, problem, {.relative_error = 1e-11});
  const Solution solution =
      solve(*room.transport, problem, {.solver = solver, .relative_error = 1e-6, .reference = exact.radiosity});
  EXPECT_TRUE(exact.converged && solution.converged);
  return solution.history.back().work;
}

// Overshooting anticipates unshot light. In a closed room with a small lamp it needs two to five times fewer shots, the
// fewer the brighter the walls are.
TEST(Overshooting, SavesMostShots) {
  Assembled room = assembled(test_room(0.5), test_room_edge);
  const auto saving = [&] {
    return work(room, room.problem, Solver::progressive) / work(room, room.problem, Solver::overshooting);
  };
  EXPECT_GT(saving(), 2);
  room.problem.scattering.reflectance.setConstant(0.8);
  EXPECT_GT(saving(), 5);
}

// Colors may disagree about the overshot amount. If an excess of one color could cancel a lack of another in the choice
// of the shooter, overshooting would need three quarters more shots than plain shooting.
TEST(Overshooting, SavesShotsInColour) {
  const Assembled room = assembled(read_scene({mesh_folder() / "two_rooms.obj"}), 0.5);
  ASSERT_EQ(room.problem.scattering.reflectance.cols(), 3);
  EXPECT_LT(work(room, room.problem, Solver::overshooting), 0.75 * work(room, room.problem, Solver::progressive));
}

}  // namespace
}  // namespace patchlight::solvers_test
