// Bounds of solutions in many bands, with common weights.
#include "patchlight/solve/solve.h"

#include "support/direct_solution.h"
#include "support/made_up_room.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::many_bands_test {
namespace {

using namespace test;

constexpr Eigen::Index bands = 8;

// A lamp, and paints of various colors.
RadiosityProblem coloured(const Room& room, double highest) {
  const Eigen::Index n = room.problem.area.size();
  RadiosityProblem problem{{Field(n, bands)}, Field::Zero(n, bands), room.problem.area};
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index band = 0; band < bands; ++band)
      problem.scattering.reflectance(i, band) = highest * std::abs(std::sin(0.7 * static_cast<double>((i % 5) + band)));
  problem.exitance.row(1) = 5;
  return problem;
}

// |B* - B|_i <= the bound of patch i in every band, and no bound is far above the tolerance.
void expect_bounds(const TransportOperator& transport, const RadiosityProblem& problem, const Solution& solution) {
  const Field exact = direct_solution(transport, problem);
  ASSERT_EQ(solution.error.cols(), bands);
  EXPECT_TRUE(((exact - solution.radiosity).abs() <= solution.error + 1e-12).all());
  EXPECT_LT(solution.patch_bound, 2e-2);
}

TEST(ManyBands, HaveBoundsThatHold) {
  const Room room = made_up(100, 0.8);
  for (const double highest : {0.3, 0.9}) {
    const RadiosityProblem problem = coloured(room, highest);
    const Solution solution = solve(*room.transport, problem, {.solver = Solver::cg, .relative_error = 1e-3});
    ASSERT_TRUE(solution.converged);
    expect_bounds(*room.transport, problem, solution);
  }
}

// If every patch reflects all light in some band, no single weights bound all bands. Each band has its own.
TEST(ManyBands, HaveBoundsWhereAllTogetherReflectEverything) {
  const Room room = made_up(100, 0.8);
  RadiosityProblem problem = coloured(room, 0.5);
  for (Eigen::Index i = 0; i < 100; ++i) problem.scattering.reflectance(i, i % bands) = 1;
  const Solution solution = solve(*room.transport, problem, {.solver = Solver::cg, .relative_error = 1e-3});
  ASSERT_TRUE(solution.converged);
  expect_bounds(*room.transport, problem, solution);
}

}  // namespace
}  // namespace patchlight::many_bands_test
