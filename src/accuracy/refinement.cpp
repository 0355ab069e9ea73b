#include "accuracy/refinement.h"

#include "patchlight/solve/solve.h"

#include "base/vectors.h"
#include "solve/scattering.h"
#include "transport/closure.h"
#include "transport/random_errors.h"

#include <algorithm>
#include <numeric>

namespace patchlight {
namespace {

// rho_i^2 / ||B - E||_A^2
Field squared_reflectance(const SolvedProblem& solved) {
  const RadiosityProblem& problem = solved.problem;
  const Eigen::ArrayXd reflected = area_norm(solved.solution.radiosity - problem.exitance, problem.area).square();
  const Eigen::ArrayXd inverse = (reflected > 0).select(reflected.inverse(), 0.0);
  return scaled(reflected_variance(problem.scattering, Field::Ones(problem.exitance.rows(), inverse.size())), inverse);
}

}  // namespace

Field weight_of_squares(const SolvedProblem& solved, const Eigen::VectorXd& weight) {
  return squared_reflectance(solved).colwise() * (weight.array().square() / solved.problem.area.array());
}

Field differences_from_parents(const NestedMesh& mesh, const SolvedProblem& solved) {
  const Field& B = solved.solution.radiosity;
  return B - of_parents(mesh, means_by_parent(mesh, B, solved.problem.area));
}

Eigen::VectorXd effects_of_parents(const ExchangeAreas& raw, const NestedMesh& mesh, const SolvedProblem& solved,
                                   const EffectsOf& of) {
  // A_i w_i^2 (rho_i / A_i sum_c S_ic difference_c)^2 / ||B - E||_A^2
  return effects_of_parts(raw, mesh, of.difference, weight_of_squares(solved, of.weight));
}

Eigen::VectorXd noise_of_parents(const HalfDifferences& differences, const NestedMesh& mesh,
                                 const SolvedProblem& solved, const Eigen::VectorXd& weight) {
  const Field B = solved.solution.radiosity;
  const Field weights = weight_of_squares(solved, weight);
  const SpanningBands spanning = spanning_bands(weights, solved.problem.area, 1e-3);
  const Field noise = B.square() * spanning.all_bands(by_variances(differences, spanning.of(weights)));
  return summed_by_parent(mesh, noise.rowwise().sum()).col(0).matrix();
}

Eigen::VectorXd squares_of_patches(const SolvedProblem& solved, const FieldView& bar, const Eigen::VectorXd& weight) {
  const Eigen::ArrayXd area = solved.problem.area.array() * weight.array().square();
  return ((squared_reflectance(solved) * bar.square()).colwise() * area).rowwise().maxCoeff().matrix();
}

Eigen::VectorXd squares_of_parents(const NestedMesh& mesh, const SolvedProblem& solved, const FieldView& bar,
                                   const Eigen::VectorXd& weight) {
  return summed_by_parent(mesh, squares_of_patches(solved, bar, weight).array()).col(0).matrix();
}

std::vector<std::uint8_t> parents_to_cut(const Eigen::VectorXd& effects, const CutGoal& goal) {
  std::vector<std::size_t> order(static_cast<std::size_t>(effects.size()));
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return effects[static_cast<Eigen::Index>(a)] > effects[static_cast<Eigen::Index>(b)];
  });
  const double all = total(effects);
  // Where one cut of everything would not suffice, those with nine tenths of the effect are cut.
  const double wanted = std::max(all / (goal.factor * goal.factor), all * (1 - 0.9 * (1 - goal.left)));
  std::vector<std::uint8_t> marks(order.size(), 0);
  if (goal.factor <= 1) return marks;
  double left = all;
  std::size_t cut = 0;
  for (const std::size_t parent : order) {
    const double effect = effects[static_cast<Eigen::Index>(parent)];
    if ((left <= wanted && cut >= goal.least) || cut == goal.most || effect == 0) break;
    left -= effect * (1 - goal.left);
    marks[parent] = 1;
    ++cut;
  }
  return marks;
}

Eigen::VectorXd importance(const TransportOperator& transport, const RadiosityProblem& problem,
                           const Eigen::VectorXd& interest) {
  // With y = R psi it reads y = R interest + R F y.
  const Field wanted = interest.array().replicate(1, problem.exitance.cols());
  const RadiosityProblem adjoint{problem.scattering, problem.scattering.adjoint(wanted), problem.area};
  SolverOptions loosely{.solver = usual_solver(transport, problem), .relative_error = 0.05, .patch_bounds = false};
  if (!transport.is_reciprocal()) {
    // A bound would cost as much as the solution. The residual is the stopping criterion, at half of the requested
    // error.
    loosely.relative_error = 0.02;
    loosely.max_iterations = 100;
    loosely.largest_row_sum = std::numeric_limits<double>::infinity();
  }
  const Solution found = solve(transport, adjoint, loosely);
  const Field psi = found.irradiance.colwise() + interest.array();
  return psi.rowwise().maxCoeff().matrix();
}

}  // namespace patchlight
