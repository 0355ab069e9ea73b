#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "base/vectors.h"
#include "mesh/nested_mesh.h"
#include "solve/scattering.h"

#include <cassert>
#include <limits>

namespace patchlight {

Field ErrorBars::total() const { return (mesh.square() + form_factor.square() + solver.square()).sqrt(); }

double relative_bar(const FieldView& bar, const RadiosityProblem& problem, const Solution& solution,
                    const Eigen::VectorXd& weight) {
  const Eigen::VectorXd area = problem.area.cwiseProduct(weight);
  const Eigen::ArrayXd error = area_norm(problem.scattering.reflect(bar), area);
  const Eigen::ArrayXd reflected = area_norm(solution.radiosity - problem.exitance, area);
  // Without reflected light every error is infinitely large.
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
  const Eigen::ArrayXd variance = 0.28 * rays_of_patches(lost, static_cast<PatchIndex>(covered.size())).pow(-1.5);
  return (covered < 1).select((variance * (covered * (1 - covered)).sqrt()).sqrt() / (1 - covered), 0.0);
}

Field dark_differences(const LostShare& lost, const SolvedProblem& solved) {
  assert(lost.dark.size() == solved.problem.area.size());
  const Eigen::ArrayXd dark = lost.dark.array();
  const Eigen::ArrayXd share = (dark < 1).select(dark.min(0.5) / (1 - dark.min(0.5)), 0.0);
  return (solved.solution.radiosity - solved.problem.exitance).colwise() * share;
}

namespace {

// Sheets are cut alike on both sides, so that the patches of a parent have those of one other on their other side.
Scattering scattering_of_parents(const NestedMesh& mesh, const RadiosityProblem& problem) {
  const Scattering& scattering = problem.scattering;
  Scattering of_parents{means_by_parent(mesh, scattering.reflectance, problem.area)};
  if (scattering.is_diagonal()) return of_parents;
  of_parents.transmittance = means_by_parent(mesh, scattering.transmittance, problem.area);
  of_parents.other_side.resize(mesh.parents.size());
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) of_parents.other_side[g] = g;
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) {
    if (scattering.other_side[i] != i) of_parents.other_side[mesh.parent[i]] = mesh.parent[scattering.other_side[i]];
  }
  return of_parents;
}

}  // namespace

RadiosityProblem problem_of_parents(const NestedMesh& mesh, const RadiosityProblem& problem) {
  RadiosityProblem of_parents;
  of_parents.scattering = scattering_of_parents(mesh, problem);
  of_parents.exitance = means_by_parent(mesh, problem.exitance, problem.area);
  if (problem.direct_irradiance.size() > 0)
    of_parents.direct_irradiance = means_by_parent(mesh, problem.direct_irradiance, problem.area);
  of_parents.area = summed_by_parent(mesh, problem.area.array()).col(0).matrix();
  return of_parents;
}

}  // namespace patchlight
