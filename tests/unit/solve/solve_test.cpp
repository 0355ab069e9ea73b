#include "patchlight/solve/solve.h"

#include "patchlight/base/error.h"

#include "support/direct_solution.h"
#include "support/made_up_room.h"
#include "transport/closure.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace patchlight::solve_test {
namespace {

using namespace test;

class EverySolver : public testing::TestWithParam<Solver> {};

TEST_P(EverySolver, AgreesWithADenseSolveToItsTolerance) {
  for (const double reflectance : {0.0, 0.5, 0.9}) {
    for (const double openness : {1.0, 1.5}) {
      const Room room = made_up(150, reflectance, openness);
      const Solution solution =
          solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-8, .max_iterations = 5000});
      ASSERT_TRUE(solution.converged);
      const Field exact = direct_solution(*room.transport, room.problem);
      const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, room.problem.area);
      const Eigen::ArrayXd reflected = area_norm(exact - room.problem.exitance, room.problem.area);
      // The bound is relative to the iterate's reflected light, which differs from the exact one's by 1e-8, plus
      // rounding.
      for (Eigen::Index band = 0; band < 3; ++band) EXPECT_LE(error[band], 1.01e-8 * reflected[band] + 1e-14);
    }
  }
}

TEST_P(EverySolver, ErrorBoundHoldsInEveryIteration) {
  // Stopped after k iterations, the true error is within the bound reported last.
  const Room room = made_up(100, 0.8);
  const Field exact = direct_solution(*room.transport, room.problem);
  for (int k = 1; k <= 6; ++k) {
    const Solution solution =
        solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-15, .max_iterations = k});
    const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, room.problem.area);
    const Eigen::ArrayXd reflected = area_norm(solution.radiosity - room.problem.exitance, room.problem.area);
    for (Eigen::Index band = 0; band < 2; ++band) {
      // The returned radiosity is one reflection better than the measured iterate.
      EXPECT_LE(error[band] / reflected[band], solution.history.back().error_bound) << k;
    }
  }
}

TEST_P(EverySolver, EmissionOnlyNeedsNoIteration) {
  const Room room = made_up(100, 0);
  const Solution solution = solve(*room.transport, room.problem, {.solver = GetParam()});
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.history.size(), 1U);
  EXPECT_TRUE((solution.radiosity == room.problem.exitance).all());
  EXPECT_GT(solution.irradiance.col(0).minCoeff(), -1e-300);
  EXPECT_GT(solution.irradiance(0, 0), 0);
}

TEST_P(EverySolver, NonConvergenceIsAnAnswer) {
  const Room room = made_up(100, 0.99);
  const Solution solution =
      solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-14, .max_iterations = 2});
  EXPECT_FALSE(solution.converged);
  EXPECT_GE(solution.history.size(), 3U);
  EXPECT_GT(solution.history.back().error_bound, 1e-14);
  EXPECT_TRUE(solution.radiosity.allFinite());
}

TEST_P(EverySolver, SaysThatASystemIsSingularBeforeIterating) {
  // rho = 1 in a closed scene: light is emitted and never absorbed.
  Room room = made_up(100, 1);
  room.problem.scattering.reflectance.setOnes();
  const Solution solution = solve(*room.transport, room.problem, {.solver = GetParam()});
  EXPECT_FALSE(solution.converged);
  EXPECT_FALSE(solution.trapped.empty());
  EXPECT_EQ(solution.history.size(), 1U);
  EXPECT_EQ(solution.history.back().error_bound, std::numeric_limits<double>::infinity());
  EXPECT_TRUE((solution.radiosity == room.problem.exitance).all());
}

// One patch that absorbs any light makes it regular.
TEST_P(EverySolver, OneAbsorbingPatchIsEnough) {
  Room room = made_up(100, 1);
  room.problem.scattering.reflectance.setOnes();
  room.problem.scattering.reflectance.row(7).setConstant(0.5);
  const Solution solution =
      solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-5, .max_iterations = 20000});
  ASSERT_TRUE(solution.converged);
  EXPECT_TRUE(solution.trapped.empty());
  const Field exact = direct_solution(*room.transport, room.problem);
  EXPECT_TRUE(((exact - solution.radiosity).abs() <= solution.error * (1 + 1e-9) + 1e-10 * exact).all());
}

// The bound of every patch holds, and it is zero where nothing is reflected.
TEST_P(EverySolver, PatchErrorsAreBounded) {
  const Room room = made_up(100, 0.8);
  const Field exact = direct_solution(*room.transport, room.problem);
  const Solution solution =
      solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-3, .max_iterations = 100});
  ASSERT_EQ(solution.error.rows(), 100);
  EXPECT_TRUE(((exact - solution.radiosity).abs() <= solution.error + 1e-12).all());
  EXPECT_TRUE((solution.error.row(2) == 0).all());
  // At most a few times the tolerance: a huge bound is useless.
  EXPECT_LT(solution.patch_bound, 1e-2);
}

TEST_P(EverySolver, StopsAtTheErrorAgainstAReference) {
  const Room room = made_up(100, 0.8);
  const Field exact = direct_solution(*room.transport, room.problem);
  const Solution solution =
      solve(*room.transport, room.problem,
            {.solver = GetParam(), .relative_error = 1e-4, .max_iterations = 1000, .reference = exact});
  ASSERT_TRUE(solution.converged);
  const auto& history = solution.history;
  for (std::size_t k = 0; k + 1 < history.size(); ++k) EXPECT_GT(history[k].true_error, 1e-4) << k;
  EXPECT_LE(history.back().true_error, 1e-4);
  EXPECT_DOUBLE_EQ(history.front().true_error, 1);
}

// Bands whose lamps differ by a factor have solutions with the same factor.
TEST_P(EverySolver, BandsOfOneColourHaveOneSolution) {
  Room room = made_up(100, 0.7);
  room.problem.exitance.col(1) = room.problem.exitance.col(0);
  room.problem.exitance.col(2) = 3 * room.problem.exitance.col(0);
  const Solution solution = solve(*room.transport, room.problem, {.solver = GetParam()});
  ASSERT_TRUE(solution.converged);
  EXPECT_TRUE((solution.radiosity.col(1) == solution.radiosity.col(0)).all());
  EXPECT_LT((solution.radiosity.col(2) - 3 * solution.radiosity.col(0)).abs().maxCoeff(), 1e-14 * 15);
  ASSERT_EQ(solution.irradiance.cols(), 3);
}

// rho = 1 with kappa = 1 / 2, because half of the light leaves.
TEST_P(EverySolver, SolvesPerfectReflectionInAnOpenScene) {
  Room room = made_up(100, 1, 2);
  room.problem.scattering.reflectance.setOnes();
  const Solution solution =
      solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-9, .max_iterations = 1000});
  ASSERT_TRUE(solution.converged);
  const Field exact = direct_solution(*room.transport, room.problem);
  const Eigen::ArrayXd error = area_norm(exact - solution.radiosity, room.problem.area);
  const Eigen::ArrayXd reflected = area_norm(exact - room.problem.exitance, room.problem.area);
  for (Eigen::Index band = 0; band < 3; ++band) EXPECT_LE(error[band], 1.01e-9 * reflected[band] + 1e-14);
}

// Rows that sum to 1.5 multiply light: it grows without limit, and that is no solution.
TEST_P(EverySolver, DivergenceIsNeverConvergence) {
  Room room = made_up(100, 0.9, 1 / 1.5);
  const Solution solution =
      solve(*room.transport, room.problem, {.solver = GetParam(), .relative_error = 1e-6, .max_iterations = 20000});
  // Krylov methods may solve this system, too. Every returned solution is one.
  EXPECT_TRUE(solution.radiosity.allFinite());
  if (!solution.converged) return;
  const Field residual = room.problem.exitance +
                         room.problem.scattering.reflectance * room.transport->apply(solution.radiosity) -
                         solution.radiosity;
  EXPECT_LT(residual.abs().maxCoeff(), 1e-3);
}

// Squares of an exitance of 1e200 overflow: no answer, but no crash.
TEST_P(EverySolver, TooStrongALampHasNoAnswer) {
  Room room = made_up(50, 0.5);
  room.problem.exitance(1, 0) = 1e200;
  const Solution solution = solve(*room.transport, room.problem, {.solver = GetParam()});
  EXPECT_FALSE(solution.converged);
  EXPECT_EQ(solution.irradiance.rows(), 50);
  EXPECT_EQ(solution.radiosity.cols(), 3);
}

TEST_P(EverySolver, WorkGrowsFromTheLamps) {
  const Room room = made_up(100, 0.9);
  const Solution solution = solve(*room.transport, room.problem, {.solver = GetParam()});
  EXPECT_EQ(solution.history.front().number, 0);
  EXPECT_DOUBLE_EQ(solution.history.front().relative_residual, 1);
  for (std::size_t k = 1; k < solution.history.size(); ++k) {
    EXPECT_GT(solution.history[k].number, solution.history[k - 1].number);
    EXPECT_GT(solution.history[k].work, solution.history[k - 1].work);
  }
}

TEST_P(EverySolver, LightFromNoPatchIsASourceWhereItIsReflected) {
  // B = E + rho o (F B + H_direct) is the problem of lamps E + rho o H_direct without any H_direct; its irradiance
  // lacks H_direct. Two solutions to 1e-9 of the reflected light.
  Room room = made_up(60, 0.6);
  room.problem.direct_irradiance = Field::Zero(60, 3);
  for (Eigen::Index i = 0; i < 60; ++i) room.problem.direct_irradiance(i, 0) = 1.0 / static_cast<double>(i + 1);
  room.problem.direct_irradiance(7, 2) = 3;
  RadiosityProblem lamps = room.problem;
  lamps.exitance = source_radiosity(room.problem);
  lamps.direct_irradiance.resize(0, 0);
  const SolverOptions options{.solver = GetParam(), .relative_error = 1e-9, .max_iterations = 5000};
  const Solution solution = solve(*room.transport, room.problem, options);
  const Solution expected = solve(*room.transport, lamps, options);
  ASSERT_TRUE(solution.converged);
  const double size = expected.radiosity.maxCoeff();
  EXPECT_LT((solution.radiosity - expected.radiosity).abs().maxCoeff(), 1e-7 * size);
  EXPECT_LT((solution.irradiance - expected.irradiance - room.problem.direct_irradiance).abs().maxCoeff(), 1e-7 * size);
  const Field straight = room.transport->apply(room.problem.exitance) + room.problem.direct_irradiance;
  EXPECT_LT((solution.direct_irradiance - straight).abs().maxCoeff(), 1e-12 * size);
  EXPECT_LT((solution.radiosity - room.problem.exitance - room.problem.scattering.reflectance * solution.irradiance)
                .abs()
                .maxCoeff(),
            1e-12 * size);
}

TEST_P(EverySolver, TellsTheObserverAllOfTheIrradiance) {
  Room room = made_up(60, 0.6);
  room.problem.direct_irradiance = Field::Constant(60, 3, 2.0);
  Field last;
  const Solution solution = solve(*room.transport, room.problem, {.solver = GetParam()}, [&](const Progress& progress) {
    if (progress.irradiance) {
      last = progress.irradiance();
      EXPECT_GE(last.minCoeff(), 2.0);
    }
    return true;
  });
  // B_k = E + rho o H_k: the last one is the solution where light is reflected.
  const Field off = room.problem.exitance + room.problem.scattering.reflectance * last - solution.radiosity;
  EXPECT_LT(off.abs().maxCoeff(), 1e-4 * solution.radiosity.maxCoeff());
}

TEST_P(EverySolver, StopsWhenTheObserverSaysSo) {
  const Room room = made_up(100, 0.9);
  const Observer observer = [](const Progress& progress) {
    return progress.iteration == nullptr || progress.iteration->number < 2;
  };
  EXPECT_THROW(solve(*room.transport, room.problem, {.solver = GetParam()}, observer), Canceled);
}

// A run that stops after the second iterate returns this iterate or one further reflection of it. The observer receives
// it last.
TEST_P(EverySolver, GivesItsLastIterateWhenThatIsAskedFor) {
  const Room room = made_up(100, 0.9);
  Field shown;
  int last = 0;
  const Observer observer = [&](const Progress& progress) {
    if (progress.iteration == nullptr) return true;
    shown = progress.irradiance();
    last = progress.iteration->number;
    return last < 2;
  };
  const Solution stopped =
      solve(*room.transport, room.problem, {.solver = GetParam(), .keeps_unfinished = true}, observer);
  EXPECT_TRUE(stopped.stopped);
  EXPECT_FALSE(stopped.converged);
  EXPECT_EQ(stopped.history.back().number, last);
  const Field iterate = radiosity_from(room.problem, shown);
  const bool shoots = is_shooting(GetParam());
  const Field expected = shoots ? iterate : radiosity_from(room.problem, room.transport->apply(iterate));
  const double rounding = 1e-12 * stopped.radiosity.maxCoeff();
  EXPECT_LT((expected - stopped.radiosity).abs().maxCoeff(), rounding);
  EXPECT_FALSE(solve(*room.transport, room.problem, {.solver = GetParam(), .keeps_unfinished = true}).stopped);
}

// H = F B only.
class Applied : public TransportOperator {
 public:
  explicit Applied(const RowTransport& transport) : transport_(transport) {}
  PatchIndex size() const override { return transport_.size(); }
  Field apply(const FieldView& radiosity) const override { return transport_.apply(radiosity); }

 private:
  const RowTransport& transport_;
};

TEST_P(EverySolver, TakesAnyTransportUnlessItTakesRows) {
  const Room room = made_up(60, 0.7);
  const Applied applied(*room.transport);
  if (takes_rows(GetParam())) {
    EXPECT_THROW(solve(applied, room.problem, {.solver = GetParam()}), InputError);
    return;
  }
  const Solution expected = solve(*room.transport, room.problem, {.solver = GetParam()});
  EXPECT_TRUE((solve(applied, room.problem, {.solver = GetParam()}).radiosity == expected.radiosity).all());
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver, testing::ValuesIn(all_solvers()), [](const auto& parameter) {
  std::string name = name_of(parameter.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace patchlight::solve_test
