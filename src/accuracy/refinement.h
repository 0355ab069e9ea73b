#pragma once

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/transport_operator.h"

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "transport/random_errors.h"

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace patchlight {

/// Differences whose effects are compared.
struct EffectsOf {
  Field difference;        ///< of radiosity, W/m^2
  Eigen::VectorXd weight;  ///< of each patch in the error
};

/// How far each patch is from the mean of its parent, radiosity in W/m^2.
Field differences_from_parents(const NestedMesh& mesh, const SolvedProblem& solved);

/// w_i^2 rho_i^2 / (A_i ||B - E||_A^2): the weight of the square of a change of A_i H_i in the error.
Field weight_of_squares(const SolvedProblem& solved, const Eigen::VectorXd& weight);

/// How much the light elsewhere changes by differences of radiosity: per parent the sum over all patches of
/// A_i w_i^2 (rho_i dH_i)^2, relative to ||B - E||_A^2, all bands. It shows where finer patches pay. After one
/// reflection. `weight` is that of each patch in the error.
Eigen::VectorXd effects_of_parents(const ExchangeAreas& raw, const NestedMesh& mesh, const SolvedProblem& solved,
                                   const EffectsOf& of);

/// The same of sampling errors: per parent the sum over its patches c and all patches i of
/// A_i w_i^2 (rho_i sigma_ic B_c / A_i)^2, relative to ||B - E||_A^2, all bands. A source that is cut into more patches
/// is sampled more.
Eigen::VectorXd noise_of_parents(const ErrorsOfEntries& errors, const NestedMesh& mesh, const SolvedProblem& solved,
                                 const Eigen::VectorXd& weight);

/// The squares of bars on the irradiance as relative_bar() adds them up, per patch, worst band.
Eigen::VectorXd squares_of_patches(const SolvedProblem& solved, const FieldView& bar, const Eigen::VectorXd& weight);

/// The same per parent.
Eigen::VectorXd squares_of_parents(const NestedMesh& mesh, const SolvedProblem& solved, const FieldView& bar,
                                   const Eigen::VectorXd& weight);

/// The share left of the squared mesh error of a parent that is cut: halving the patches' size gains 2^mesh_order.
inline const double mesh_error_left = std::pow(2.0, -2 * mesh_order);

/// The share left of a squared sampling error with four times the samples.
inline constexpr double noise_left = 0.25;

/// The aim of cutting parents.
struct CutGoal {
  double factor = 1;              ///< by which the error has to fall
  double left = mesh_error_left;  ///< of the squared effect of a parent that is cut
  std::size_t least = 0;          ///< parents that are cut, if any
  std::size_t most = std::numeric_limits<std::size_t>::max();
};

/// The least number of parents that have to be cut for the error to fall, the most effective first: marks per parent.
/// Where cutting all would not suffice, those with nine tenths of the effect; within the limits, but none without an
/// effect, and none when nothing has to fall.
std::vector<std::uint8_t> parents_to_cut(const Eigen::VectorXd& effects, const CutGoal& goal);

/// How much a change of each patch's irradiance matters to the light on the patches of `interest` (1 or 0 per patch):
/// the solution of the adjoint equation psi = interest + F R psi, worst band. As S is symmetric, F is its own adjoint
/// in the norm weighted by area; of rows of rays it is but for their errors.
Eigen::VectorXd importance(const TransportOperator& transport, const RadiosityProblem& problem,
                           const Eigen::VectorXd& interest);

}  // namespace patchlight
