#include "patchlight/solve/solve.h"

#include "patchlight/base/error.h"
#include "patchlight/transport/dense.h"

#include "support/direct_solution.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace patchlight {
namespace {

using test::direct_solution;

// A made-up closed scene: symmetric positive exchange areas, areas their row sums times `openness`.
struct Box {
  std::unique_ptr<RowTransport> transport;
  RadiosityProblem problem;
};

Box made_up(PatchIndex n, double reflectance, double openness = 1) {
  ExchangeAreas S(n);
  for (PatchIndex i = 0; i < n; ++i) {
    for (PatchIndex j = i + 1; j < n; ++j) {
      const auto entry = static_cast<float>(0.1 + 0.9 * std::abs(std::sin(1.7 * i + 0.3 * j * j)));
      const PatchIndex I = i / ExchangeAreas::edge;
      const PatchIndex J = j / ExchangeAreas::edge;
      const std::size_t r = i % ExchangeAreas::edge;
      const std::size_t c = j % ExchangeAreas::edge;
      S.tile(I, J)[r * ExchangeAreas::edge + c] = entry;
      if (I == J) S.tile(I, J)[c * ExchangeAreas::edge + r] = entry;
    }
  }
  const Eigen::VectorXd area = openness * row_sums(S);
  RadiosityProblem problem{Field::Constant(n, 3, reflectance), Field::Zero(n, 3), area};
  // Two lamps of different colour; the third band has no light at all; one patch is black.
  problem.exitance(1, 0) = 5;
  problem.exitance(n - 1, 1) = 2;
  problem.reflectance.row(2) = 0;
  return {dense_transport(keep_exchange_areas(std::move(S), "test"), area), std::move(problem)};
}

class EverySolver : public testing::TestWithParam<Solver> {};

TEST_P(EverySolver, AgreesWithADenseSolveToItsTolerance) {
  for (const double reflectance : {0.0, 0.5, 0.9}) {
    for (const double openness : {1.0, 1.5}) {
      const Box box = made_up(150, reflectance, openness);
      const Solution solution =
          solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-8, .max_iterations = 5000});
      ASSERT_TRUE(solution.converged);
      const Field exact = direct_solution(*box.transport, box.problem);
      const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, box.problem.area);
      const Eigen::ArrayXd reflected = area_norm(exact - box.problem.exitance, box.problem.area);
      // The bound is relative to the iterate's reflected light, which differs from the exact one's by 1e-8; plus
      // rounding.
      for (Eigen::Index band = 0; band < 3; ++band) EXPECT_LE(error[band], 1.01e-8 * reflected[band] + 1e-14);
    }
  }
}

TEST_P(EverySolver, ErrorBoundHoldsInEveryIteration) {
  // Stopped after k iterations, the true error is within the bound reported last.
  const Box box = made_up(100, 0.8);
  const Field exact = direct_solution(*box.transport, box.problem);
  for (int k = 1; k <= 6; ++k) {
    const Solution solution =
        solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-15, .max_iterations = k});
    const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, box.problem.area);
    const Eigen::ArrayXd reflected = area_norm(solution.radiosity - box.problem.exitance, box.problem.area);
    for (Eigen::Index band = 0; band < 2; ++band) {
      // The radiosity handed out is one reflection better than the iterate that was measured.
      EXPECT_LE(error[band] / reflected[band], solution.history.back().error_bound) << k;
    }
  }
}

TEST_P(EverySolver, EmissionOnlyNeedsNoIteration) {
  const Box box = made_up(100, 0);
  const Solution solution = solve(*box.transport, box.problem, {.solver = GetParam()});
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.history.size(), 1U);
  EXPECT_TRUE((solution.radiosity == box.problem.exitance).all());
  EXPECT_GT(solution.irradiance.col(0).minCoeff(), -1e-300);
  EXPECT_GT(solution.irradiance(0, 0), 0);
}

TEST_P(EverySolver, NonConvergenceIsAnAnswer) {
  const Box box = made_up(100, 0.99);
  const Solution solution =
      solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-14, .max_iterations = 2});
  EXPECT_FALSE(solution.converged);
  EXPECT_GE(solution.history.size(), 3U);
  EXPECT_GT(solution.history.back().error_bound, 1e-14);
  EXPECT_TRUE(solution.radiosity.allFinite());
}

TEST_P(EverySolver, SaysThatASystemIsSingularBeforeIterating) {
  // rho = 1 in a closed scene: light is emitted and never absorbed.
  Box box = made_up(100, 1);
  box.problem.reflectance.setOnes();
  const Solution solution = solve(*box.transport, box.problem, {.solver = GetParam()});
  EXPECT_FALSE(solution.converged);
  EXPECT_FALSE(solution.trapped.empty());
  EXPECT_EQ(solution.history.size(), 1U);
  EXPECT_EQ(solution.history.back().error_bound, std::numeric_limits<double>::infinity());
  EXPECT_TRUE((solution.radiosity == box.problem.exitance).all());
}

// One patch that absorbs makes it regular, however little.
TEST_P(EverySolver, OneAbsorbingPatchIsEnough) {
  Box box = made_up(100, 1);
  box.problem.reflectance.setOnes();
  box.problem.reflectance.row(7).setConstant(0.5);
  const Solution solution =
      solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-5, .max_iterations = 20000});
  ASSERT_TRUE(solution.converged);
  EXPECT_TRUE(solution.trapped.empty());
  const Field exact = direct_solution(*box.transport, box.problem);
  EXPECT_TRUE(((exact - solution.radiosity).abs() <= solution.error * (1 + 1e-9) + 1e-10 * exact).all());
}

// The bound of every patch holds, and it is none where nothing is reflected.
TEST_P(EverySolver, PatchErrorsAreBounded) {
  const Box box = made_up(100, 0.8);
  const Field exact = direct_solution(*box.transport, box.problem);
  const Solution solution =
      solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-3, .max_iterations = 100});
  ASSERT_EQ(solution.error.rows(), 100);
  EXPECT_TRUE(((exact - solution.radiosity).abs() <= solution.error + 1e-12).all());
  EXPECT_TRUE((solution.error.row(2) == 0).all());
  // Not more than some times the tolerance: a bound that is always huge is none.
  EXPECT_LT(solution.patch_bound, 1e-2);
}

TEST_P(EverySolver, StopsAtTheErrorAgainstAReference) {
  const Box box = made_up(100, 0.8);
  const Field exact = direct_solution(*box.transport, box.problem);
  const Solution solution =
      solve(*box.transport, box.problem,
            {.solver = GetParam(), .relative_error = 1e-4, .max_iterations = 1000, .reference = exact});
  ASSERT_TRUE(solution.converged);
  const auto& history = solution.history;
  for (std::size_t k = 0; k + 1 < history.size(); ++k) EXPECT_GT(history[k].true_error, 1e-4) << k;
  EXPECT_LE(history.back().true_error, 1e-4);
  EXPECT_DOUBLE_EQ(history.front().true_error, 1);
}

// Bands whose lamps differ by a factor have solutions that do.
TEST_P(EverySolver, BandsOfOneColourHaveOneSolution) {
  Box box = made_up(100, 0.7);
  box.problem.exitance.col(1) = box.problem.exitance.col(0);
  box.problem.exitance.col(2) = 3 * box.problem.exitance.col(0);
  const Solution solution = solve(*box.transport, box.problem, {.solver = GetParam()});
  ASSERT_TRUE(solution.converged);
  EXPECT_TRUE((solution.radiosity.col(1) == solution.radiosity.col(0)).all());
  EXPECT_LT((solution.radiosity.col(2) - 3 * solution.radiosity.col(0)).abs().maxCoeff(), 1e-14 * 15);
  ASSERT_EQ(solution.irradiance.cols(), 3);
}

// rho = 1 with kappa = 1 / 2, as half of the light leaves.
TEST_P(EverySolver, SolvesPerfectReflectionInAnOpenScene) {
  Box box = made_up(100, 1, 2);
  box.problem.reflectance.setOnes();
  const Solution solution =
      solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-9, .max_iterations = 1000});
  ASSERT_TRUE(solution.converged);
  const Field exact = direct_solution(*box.transport, box.problem);
  const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, box.problem.area);
  const Eigen::ArrayXd reflected = area_norm(exact - box.problem.exitance, box.problem.area);
  for (Eigen::Index band = 0; band < 3; ++band) EXPECT_LE(error[band], 1.01e-9 * reflected[band] + 1e-14);
}

// Rows that sum up to 1.5 make more light of light: it grows beyond all numbers, and that is no solution.
TEST_P(EverySolver, DivergenceIsNeverConvergence) {
  Box box = made_up(100, 0.9, 1 / 1.5);
  const Solution solution =
      solve(*box.transport, box.problem, {.solver = GetParam(), .relative_error = 1e-6, .max_iterations = 20000});
  // Krylov methods may solve this system, too; what is handed out as a solution is one.
  EXPECT_TRUE(solution.radiosity.allFinite());
  if (!solution.converged) return;
  const Field residual =
      box.problem.exitance + box.problem.reflectance * box.transport->apply(solution.radiosity) - solution.radiosity;
  EXPECT_LT(residual.abs().maxCoeff(), 1e-3);
}

TEST_P(EverySolver, WorkGrowsFromTheLamps) {
  const Box box = made_up(100, 0.9);
  const Solution solution = solve(*box.transport, box.problem, {.solver = GetParam()});
  EXPECT_EQ(solution.history.front().number, 0);
  EXPECT_DOUBLE_EQ(solution.history.front().relative_residual, 1);
  for (std::size_t k = 1; k < solution.history.size(); ++k) {
    EXPECT_GT(solution.history[k].number, solution.history[k - 1].number);
    EXPECT_GT(solution.history[k].work, solution.history[k - 1].work);
  }
}

// Jacobi's residuals fall as ||K||_A < 1, those of GMRES as it minimises them over ever more directions, restarts
// included.
TEST(Residuals, FallForJacobiAndGmres) {
  const Box box = made_up(100, 0.9);
  for (const auto& [solver, restart] : {std::pair(Solver::jacobi, 1), {Solver::gmres, 30}, {Solver::gmres, 2}}) {
    const Solution solution = solve(*box.transport, box.problem, {.solver = solver, .restart = restart});
    ASSERT_TRUE(solution.converged);
    for (std::size_t k = 1; k < solution.history.size(); ++k) {
      EXPECT_LT(solution.history[k].relative_residual, solution.history[k - 1].relative_residual) << k;
    }
  }
}

TEST_P(EverySolver, StopsWhenTheObserverSaysSo) {
  const Box box = made_up(100, 0.9);
  const Observer observer = [](const Progress& progress) {
    return progress.iteration == nullptr || progress.iteration->number < 2;
  };
  EXPECT_THROW(solve(*box.transport, box.problem, {.solver = GetParam()}, observer), Cancelled);
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver, testing::ValuesIn(all_solvers()), [](const auto& parameter) {
  std::string name = name_of(parameter.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Jacobi, IterationKAddsBounceK) {
  const Box box = made_up(80, 0.7);
  Field bounce = box.problem.exitance;
  Field sum = bounce;
  for (int k = 1; k <= 4; ++k) {
    bounce = box.problem.reflectance * box.transport->apply(bounce);
    sum += bounce;
    // Iterate k - 1 is measured in iteration k - 1 and handed out one bounce on.
    const Solution solution = solve(*box.transport, box.problem,
                                    {.solver = Solver::jacobi, .relative_error = 1e-15, .max_iterations = k - 1});
    EXPECT_LT((solution.radiosity - sum).abs().maxCoeff(), 1e-14 * sum.maxCoeff());
  }
}

TEST(GaussSeidel, NeedsAboutHalfOfJacobisIterations) {
  // For rho near 1 the slowest mode of both is nearly constant; Gauss-Seidel reduces it about twice per sweep (Young
  // 1971 has exactly twice for consistently ordered matrices, which this is not).
  const Box box = made_up(200, 0.9);
  const auto iterations = [&](Solver solver) {
    return static_cast<double>(
        solve(*box.transport, box.problem, {.solver = solver, .max_iterations = 5000}).history.size());
  };
  const double ratio = iterations(Solver::gauss_seidel) / iterations(Solver::jacobi);
  EXPECT_GT(ratio, 0.3);
  EXPECT_LT(ratio, 0.7);
}

TEST(ProgressiveRefinement, AmbientTermEstimatesWhatIsUnderWay) {
  // Early on, the display with the ambient term is closer to the answer than without.
  const Box box = made_up(100, 0.8);
  const Field exact = direct_solution(*box.transport, box.problem);
  const Solution early =
      solve(*box.transport, box.problem, {.solver = Solver::progressive, .relative_error = 1e-15, .max_iterations = 0});
  const Field shown = early.radiosity + box.problem.reflectance * early.ambient;
  const double without = area_norm(exact - early.radiosity, box.problem.area)[0];
  const double with = area_norm(exact - shown, box.problem.area)[0];
  EXPECT_LT(with, 0.5 * without);
}

TEST(ProgressiveRefinement, StopsAfterSoManyRows) {
  // Of 100 rows two are those of the lamps, which always shoot.
  const Box box = made_up(100, 0.8);
  for (const Solver solver : {Solver::progressive, Solver::overshooting}) {
    const auto stopped = [&](double max_rows, int max_iterations) {
      const SolverOptions options{.solver = solver,
                                  .relative_error = 1e-15,
                                  .max_iterations = max_iterations,
                                  .max_rows = max_rows,
                                  .largest_row_sum = std::numeric_limits<double>::infinity()};
      return solve(*box.transport, box.problem, options);
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
}  // namespace patchlight
