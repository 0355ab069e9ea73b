#include "patchlight/solve/solve.h"

#include "transport/closure.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace patchlight::iterates_test {
namespace {

// Four patches of different areas in a closed room, with a symmetric S whose rows sum to the areas.
std::unique_ptr<RowTransport> closed_transport() {
  Eigen::Matrix4d S;
  S << 0, 0.5, 0.25, 0.25, 0.5, 0, 0.5, 0.5, 0.25, 0.5, 0, 0.25, 0.25, 0.5, 0.25, 0;
  ExchangeAreas areas(4);
  for (PatchIndex i = 0; i < 4; ++i) {
    for (PatchIndex j = i; j < 4; ++j) areas.set(i, j, static_cast<float>(S(i, j)));
  }
  return dense_transport({std::move(areas), Eigen::VectorXd::Zero(4), "none"}, S.rowwise().sum());
}

RadiosityProblem lamp_and_walls() {
  RadiosityProblem problem{{Field::Constant(4, 2, 0.5)}, Field::Zero(4, 2), Eigen::Vector4d(1, 1.5, 1, 1)};
  problem.scattering.reflectance.row(0).setZero();
  problem.exitance.row(0) << 8, 4;
  return problem;
}

// The solution and the iterates that the observer saw.
struct Watched {
  Solution solution;
  std::vector<Field> irradiance;
};

Watched watched(Solver solver, const RowTransport& transport, const RadiosityProblem& problem) {
  Watched result;
  result.solution =
      solve(transport, problem, {.solver = solver, .relative_error = 1e-9}, [&](const Progress& progress) {
        if (progress.irradiance) result.irradiance.push_back(progress.irradiance());
        return true;
      });
  return result;
}

std::string solver_name(const testing::TestParamInfo<Solver>& parameter) {
  std::string name = name_of(parameter.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

class Iterates : public testing::TestWithParam<Solver> {};

TEST_P(Iterates, GoWithTheHistoryFromTheLampsToTheSolution) {
  const auto transport = closed_transport();
  const RadiosityProblem problem = lamp_and_walls();
  const Watched run = watched(GetParam(), *transport, problem);
  ASSERT_TRUE(run.solution.converged);
  ASSERT_EQ(run.irradiance.size(), run.solution.history.size());
  EXPECT_TRUE((run.irradiance.front() == 0).all());
  // The last one is within the tolerance of the solution. The norm of 4 patches is at most 3 times a value.
  const double largest = run.solution.irradiance.maxCoeff();
  EXPECT_LE((run.irradiance.back() - run.solution.irradiance).abs().maxCoeff(), 3e-9 * largest);
}

TEST_P(Iterates, DirectIrradianceComesFromTheLampsAlone) {
  const auto transport = closed_transport();
  const RadiosityProblem problem = lamp_and_walls();
  const Watched run = watched(GetParam(), *transport, problem);
  const Field direct = transport->apply(problem.exitance);
  EXPECT_TRUE((run.solution.direct_irradiance == direct).all());
  EXPECT_TRUE((run.solution.irradiance >= direct * (1 - 1e-14)).all());
}

INSTANTIATE_TEST_SUITE_P(Solvers, Iterates, testing::ValuesIn(all_solvers()), solver_name);

// Light only increases: from a dark start every iterate lies between the previous one and the solution.
class GrowingIterates : public testing::TestWithParam<Solver> {};

TEST_P(GrowingIterates, GrowTowardsTheSolution) {
  const auto transport = closed_transport();
  const Watched run = watched(GetParam(), *transport, lamp_and_walls());
  for (std::size_t k = 1; k < run.irradiance.size(); ++k) {
    EXPECT_TRUE((run.irradiance[k] >= run.irradiance[k - 1] * (1 - 1e-14)).all()) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, GrowingIterates,
                         testing::Values(Solver::jacobi, Solver::gauss_seidel, Solver::symmetric_gauss_seidel,
                                         Solver::progressive),
                         solver_name);

// Iterate k of Jacobi's method has k bounces: H_k = F (E + rho o H_(k-1)), H_1 = F E.
TEST(Jacobi, IterateKIsBounceK) {
  const auto transport = closed_transport();
  const RadiosityProblem problem = lamp_and_walls();
  const Watched run = watched(Solver::jacobi, *transport, problem);
  ASSERT_GT(run.irradiance.size(), 3U);
  EXPECT_TRUE((run.irradiance[1] == run.solution.direct_irradiance).all());
  for (std::size_t k = 1; k < run.irradiance.size(); ++k) {
    const Field expected = transport->apply(problem.exitance + problem.scattering.reflectance * run.irradiance[k - 1]);
    EXPECT_TRUE((run.irradiance[k] == expected).all()) << k;
  }
}

}  // namespace
}  // namespace patchlight::iterates_test
