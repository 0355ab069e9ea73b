#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "base/vectors.h"
#include "mesh/nested_mesh.h"
#include "solve/scattering.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace patchlight {

Field ErrorBars::total() const { return (mesh.square() + form_factor.square() + solver.square()).sqrt(); }

double relative_bar(const FieldView& bar, const RadiosityProblem& problem, const Solution& solution,
                    const Eigen::VectorXd& weight) {
  const Eigen::VectorXd area = problem.area.cwiseProduct(weight);
  const Eigen::ArrayXd error = area_norm(problem.scattering.reflect(bar), area);
  const Eigen::ArrayXd reflected = area_norm(solution.radiosity - problem.exitance, area);
  // Of what reflects nothing every error is infinitely large.
  const Eigen::ArrayXd relative = (error == 0).select(0.0, error / reflected);
  return relative.isNaN().any() ? std::numeric_limits<double>::infinity() : largest(relative);
}

Field solver_errors(const SolvedProblem& solved) {
  const Field& H = solved.solution.irradiance;
  const Field& error = solved.solution.error;
  if (error.size() == 0) return Field::Constant(H.rows(), H.cols(), std::numeric_limits<double>::infinity());
  return irradiance_errors(solved.problem.scattering, error);
}

Eigen::ArrayXd exposure_errors(const LostShare& lost) {
  const Eigen::ArrayXd covered = lost.covered.array();
  // Measured for straight edges in every direction, where from 1 to 99 % are covered:
  // tests/unit/transport/lost_share_test.cpp.
  const double variance = 0.28 * std::pow(static_cast<double>(lost.rays_per_patch), -1.5);
  return (covered < 1).select((variance * (covered * (1 - covered)).sqrt()).sqrt() / (1 - covered), 0.0);
}

Field dark_differences(const LostShare& lost, const SolvedProblem& solved) {
  assert(lost.dark.size() == solved.problem.area.size());
  const Eigen::ArrayXd dark = lost.dark.array();
  const Eigen::ArrayXd share = (dark < 1).select(dark.min(0.5) / (1 - dark.min(0.5)), 0.0);
  return (solved.solution.radiosity - solved.problem.exitance).colwise() * share;
}

RadiosityProblem problem_of_parents(const NestedMesh& mesh, const RadiosityProblem& problem) {
  RadiosityProblem of_parents;
  of_parents.scattering = {means_by_parent(mesh, problem.scattering.reflectance, problem.area)};
  of_parents.exitance = means_by_parent(mesh, problem.exitance, problem.area);
  if (problem.direct_irradiance.size() > 0)
    of_parents.direct_irradiance = means_by_parent(mesh, problem.direct_irradiance, problem.area);
  of_parents.area = summed_by_parent(mesh, problem.area.array()).col(0).matrix();
  return of_parents;
}

}  // namespace patchlight
