// Guarantees of single methods.
#include "patchlight/solve/solve.h"

#include "base/vectors.h"
#include "support/direct_solution.h"
#include "support/made_up_room.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <utility>

namespace patchlight::methods_test {
namespace {

using namespace test;

// Jacobi's residuals decrease because ||K||_A < 1. Those of GMRES decrease because it minimizes them over more and more
// directions, with and without restarts.
TEST(Residuals, FallForJacobiAndGmres) {
  const Room room = made_up(100, 0.9);
  for (const auto& [solver, restart] : {std::pair(Solver::jacobi, 1), {Solver::gmres, 30}, {Solver::gmres, 2}}) {
    const Solution solution = solve(*room.transport, room.problem, {.solver = solver, .restart = restart});
    ASSERT_TRUE(solution.converged);
    for (std::size_t k = 1; k < solution.history.size(); ++k) {
      EXPECT_LT(solution.history[k].relative_residual, solution.history[k - 1].relative_residual) << k;
    }
  }
}

// Without a known bound, iterates are computed only for an observer that requests them. Their residuals are those in
// the history, including restarts. The request changes nothing.
TEST(Gmres, MakesTheIteratesWhoseResidualsItTells) {
  const Room room = made_up(100, 0.9);
  const double none = std::numeric_limits<double>::infinity();
  for (const int restart : {30, 3}) {
    const SolverOptions options{
        .solver = Solver::gmres, .relative_error = 1e-6, .restart = restart, .largest_row_sum = none};
    const Eigen::ArrayXd first =
        area_norm(room.problem.scattering.reflect(room.transport->apply(room.problem.exitance)), room.problem.area);
    int looked = 0;
    const Solution solution = solve(*room.transport, room.problem, options, [&](const Progress& progress) {
      if (!progress.irradiance) return true;
      const Field B = radiosity_from(room.problem, progress.irradiance());
      const Field residual = radiosity_from(room.problem, room.transport->apply(B)) - B;
      const Eigen::ArrayXd norm = area_norm(residual, room.problem.area);
      double relative = 0;
      for (Eigen::Index band = 0; band < 2; ++band) relative = std::max(relative, norm[band] / first[band]);
      EXPECT_NEAR(progress.iteration->relative_residual, relative, 1e-12) << "iteration " << progress.iteration->number;
      ++looked;
      return true;
    });
    ASSERT_TRUE(solution.converged);
    EXPECT_EQ(looked, static_cast<int>(solution.history.size()));
    EXPECT_EQ(solution.history.back().error_bound, none);
    EXPECT_TRUE((solve(*room.transport, room.problem, options).radiosity == solution.radiosity).all());
  }
}

TEST(Jacobi, IterationKAddsBounceK) {
  const Room room = made_up(80, 0.7);
  Field bounce = room.problem.exitance;
  Field sum = bounce;
  for (int k = 1; k <= 4; ++k) {
    bounce = room.problem.scattering.reflectance * room.transport->apply(bounce);
    sum += bounce;
    // Iterate k - 1 is measured in iteration k - 1, and passed on after one more bounce.
    const Solution solution = solve(*room.transport, room.problem,
                                    {.solver = Solver::jacobi, .relative_error = 1e-15, .max_iterations = k - 1});
    EXPECT_LT((solution.radiosity - sum).abs().maxCoeff(), 1e-14 * sum.maxCoeff());
  }
}

TEST(GaussSeidel, NeedsAboutHalfOfJacobisIterations) {
  // For rho near 1 the slowest mode of both is nearly constant. Gauss-Seidel reduces it about twice per sweep. Young
  // 1971 has exactly twice for consistently ordered matrices, but this one is not.
  const Room room = made_up(200, 0.9);
  const auto iterations = [&](Solver solver) {
    return static_cast<double>(
        solve(*room.transport, room.problem, {.solver = solver, .max_iterations = 5000}).history.size());
  };
  const double ratio = iterations(Solver::gauss_seidel) / iterations(Solver::jacobi);
  EXPECT_GT(ratio, 0.3);
  EXPECT_LT(ratio, 0.7);
}

TEST(ProgressiveRefinement, AmbientTermEstimatesWhatIsUnderWay) {
  // Early on, the display with the ambient term is closer to the solution than without.
  const Room room = made_up(100, 0.8);
  const Field exact = direct_solution(*room.transport, room.problem);
  const Solution early = solve(*room.transport, room.problem,
                               {.solver = Solver::progressive, .relative_error = 1e-15, .max_iterations = 0});
  const Field shown = early.radiosity + room.problem.scattering.reflectance * early.ambient;
  const double without = area_norm(exact - early.radiosity, room.problem.area)[0];
  const double with = area_norm(exact - shown, room.problem.area)[0];
  EXPECT_LT(with, 0.5 * without);
}

TEST(ProgressiveRefinement, StopsAfterSoManyRows) {
  // Two of 100 rows belong to the lamps, which always shoot.
  const Room room = made_up(100, 0.8);
  for (const Solver solver : {Solver::progressive, Solver::overshooting}) {
    const auto stopped = [&](double max_rows, int max_iterations) {
      const SolverOptions options{.solver = solver,
                                  .relative_error = 1e-15,
                                  .max_iterations = max_iterations,
                                  .max_rows = max_rows,
                                  .largest_row_sum = std::numeric_limits<double>::infinity()};
      return solve(*room.transport, room.problem, options);
    };
    EXPECT_EQ(stopped(0.001, 5).history.back().number, 0);
    EXPECT_EQ(stopped(0.255, 5).history.back().number, 23);
    EXPECT_NEAR(stopped(0.255, 5).history.back().work, 0.25, 1e-12);
    EXPECT_EQ(stopped(1.5, 5).history.back().number, 148);
    EXPECT_EQ(stopped(1e9, 2).history.back().number, 200);
    EXPECT_FALSE(stopped(1.5, 5).converged);
  }
}

}  // namespace
}  // namespace patchlight::methods_test
