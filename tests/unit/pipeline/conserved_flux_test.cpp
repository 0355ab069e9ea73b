#include "base/vectors.h"
#include "pipeline/solve_with_rays.h"

#include <gtest/gtest.h>

namespace patchlight::conserved_flux_test {
namespace {

// Rows of a closed space. They sum to 1, but area-weighted columns do not.
const Eigen::Matrix3d factors{{0, 0.7, 0.3}, {0.45, 0, 0.55}, {0.4, 0.6, 0}};
const Eigen::VectorXd row_sum = factors.rowwise().sum();

// One half of the rows. The other half has the complement.
RayRows half_of_rows(double off) {
  RayRows rows;
  rows.first_hit.assign(4, 0);
  rows.hit_weight.assign(3, 0);
  rows.first_entry = {0};
  for (PatchIndex i = 0; i < 3; ++i) {
    for (PatchIndex j = 0; j < 3; ++j) {
      if (i == j) continue;
      const double share = 1 + (j == (i + 1) % 3 ? off : -off);
      rows.entries.push_back({j, static_cast<float>(share * factors(i, j))});
    }
    rows.first_entry.push_back(rows.entries.size());
  }
  return rows;
}

RaysWithPockets two_halves() {
  return {RayTransport({half_of_rows(0.1), half_of_rows(-0.1)}), Eigen::VectorXd::Constant(3, 0.8)};
}

const Eigen::VectorXd area = Eigen::Vector3d(1, 1.5, 2);

RadiosityProblem lit(double reflectance) {
  Field exitance = Field::Zero(3, 2);
  exitance(0, 0) = 10;  // the second band is dark
  return {{Field::Constant(3, 2, reflectance)}, exitance, area};
}

Solution solved(const RaysWithPockets& rows, const RadiosityProblem& problem) {
  return solve(rows, problem, {.solver = Solver::gmres, .relative_error = 1e-12});
}

// sum_i A_i (F B + g d(B))_i = sum_j A_j s_j B_j by construction. B solves B = E + R (F B + g d(B)), within 1 % of the
// added light, the tolerance of the second solution.
TEST(ConservedFlux, IsThatOfTheSolution) {
  const RaysWithPockets rows = two_halves();
  const RadiosityProblem problem = lit(0.8);
  const Solution plain = solved(rows, problem);
  const auto [solution, flux, gathered] = conserving_flux(rows, problem, plain, row_sum);
  for (std::size_t half = 0; half < 2; ++half) {
    const Field by_half = rows.rays().apply_half(half, solution.radiosity);
    EXPECT_LT((gathered[half] - by_half).abs().maxCoeff(), 1e-12 * by_half.maxCoeff()) << "rounding";
  }
  const Field of_all = 0.5 * (gathered[0] + gathered[1]);
  const Field irradiance = flux.completed(of_all, solution.radiosity, area);
  const Eigen::VectorXd seen = area.cwiseProduct(row_sum);
  EXPECT_NEAR(area_sum(irradiance, area)[0], area_sum(solution.radiosity, seen)[0], 1e-9);
  const Field again = problem.exitance + problem.scattering.reflect(irradiance);
  const double added = (solution.radiosity - plain.radiosity).abs().maxCoeff();
  EXPECT_GT(added, 1e-2) << "there is something to be added";
  EXPECT_LT((again - solution.radiosity).abs().maxCoeff(), 0.02 * added);
  EXPECT_EQ(solution.radiosity.col(1).abs().maxCoeff(), 0);
}

TEST(ConservedFlux, LeavesWhatHasNotConverged) {
  const RaysWithPockets rows = two_halves();
  const RadiosityProblem problem = lit(0.8);
  Solution plain = solved(rows, problem);
  plain.converged = false;
  const auto [solution, flux, gathered] = conserving_flux(rows, problem, plain, row_sum);
  EXPECT_TRUE((solution.radiosity == plain.radiosity).all());
  EXPECT_EQ(flux.shape.abs().maxCoeff(), 0);
}

// A space that loses a tenth of its light is open, for example a room with a window. It keeps its solution.
TEST(ConservedFlux, LeavesOpenSpaces) {
  const RaysWithPockets rows = two_halves();
  const Eigen::VectorXd open = 0.9 * row_sum;
  const RadiosityProblem problem = lit(0.8);
  EXPECT_EQ(find_closed_spaces(rows.rays(), problem, open).count, 0);
  const Solution plain = solved(rows, problem);
  EXPECT_TRUE((conserving_flux(rows, problem, plain, open).solution.radiosity == plain.radiosity).all());
}

}  // namespace
}  // namespace patchlight::conserved_flux_test
