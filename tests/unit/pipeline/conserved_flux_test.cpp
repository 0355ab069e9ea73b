#include "pipeline/conserved_flux.h"

#include "base/vectors.h"

#include <gtest/gtest.h>

namespace patchlight::conserved_flux_test {
namespace {

// Rows that sum up to what is seen; columns do not.
class Rows : public TransportOperator {
 public:
  PatchIndex size() const override { return 3; }
  Field apply(const FieldView& radiosity) const override { return (factors_ * radiosity.matrix()).array(); }
  bool is_reciprocal() const override { return false; }
  Eigen::VectorXd row_sum() const { return factors_.rowwise().sum(); }

 private:
  Eigen::Matrix3d factors_{{0, 0.7, 0.3}, {0.45, 0, 0.55}, {0.35, 0.5, 0}};
};

const Eigen::VectorXd area = Eigen::Vector3d(1, 1.5, 2);

RadiosityProblem lit(double reflectance) {
  Field exitance = Field::Zero(3, 2);
  exitance(0, 0) = 10;  // the second band is dark
  return {{Field::Constant(3, 2, reflectance)}, exitance, area};
}

Solution solved(const Rows& rows, const RadiosityProblem& problem) {
  return solve(rows, problem, {.solver = Solver::gmres, .relative_error = 1e-12});
}

// sum_i A_i (F B + g d(B))_i = sum_j A_j s_j B_j by construction, and B solves B = E + R (F B + g d(B)): to the 1 % of
// what is added that the second solution may leave.
TEST(ConservedFlux, IsThatOfTheSolution) {
  const Rows rows;
  const RadiosityProblem problem = lit(0.8);
  const Solution plain = solved(rows, problem);
  const auto [solution, flux] = conserving_flux(rows, problem, plain, rows.row_sum());
  const Field irradiance = flux.completed(rows.apply(solution.radiosity), solution.radiosity, area);
  const Eigen::VectorXd seen = area.cwiseProduct(rows.row_sum());
  EXPECT_NEAR(area_sum(irradiance, area)[0], area_sum(solution.radiosity, seen)[0], 1e-9);
  const Field again = problem.exitance + problem.scattering.reflect(irradiance);
  const double added = (solution.radiosity - plain.radiosity).abs().maxCoeff();
  EXPECT_GT(added, 1e-2) << "there is something to be added";
  EXPECT_LT((again - solution.radiosity).abs().maxCoeff(), 0.02 * added);
  EXPECT_EQ(solution.radiosity.col(1).abs().maxCoeff(), 0);
}

TEST(ConservedFlux, LeavesWhatHasNotConverged) {
  const Rows rows;
  const RadiosityProblem problem = lit(0.8);
  Solution plain = solved(rows, problem);
  plain.converged = false;
  const auto [solution, flux] = conserving_flux(rows, problem, plain, rows.row_sum());
  EXPECT_TRUE((solution.radiosity == plain.radiosity).all());
  EXPECT_EQ(flux.shape.abs().maxCoeff(), 0);
}

}  // namespace
}  // namespace patchlight::conserved_flux_test
