#pragma once

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/transport/exchange_areas.h"
#include "patchlight/transport/half_differences.h"
#include "patchlight/transport/transport_operator.h"

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace patchlight {

/// The input of effects_of_parents().
struct EffectsOf {
  Field difference;        ///< of radiosity from the parent's mean, W/m^2
  Eigen::VectorXd weight;  ///< of each patch in the error
};

/// The difference of each patch from the mean of its parent, radiosity in W/m^2.
Field differences_from_parents(const NestedMesh& mesh, const SolvedProblem& solved);

/// The weight of the squared change of A_i H_i in the error: w_i^2 rho_i^2 / (A_i
///
/// B - E
///
/// _A^2).
Field weight_of_squares(const SolvedProblem& solved, const Eigen::VectorXd& weight);

/// The effect of differences of radiosity on other patches, after one reflection: per parent the sum over all patches
/// of A_i w_i^2 (rho_i dH_i)^2, relative to
///
/// B - E
///
/// _A^2, all bands. It shows where finer patches reduce the error most. `weight` is that of each patch in the error.
Eigen::VectorXd effects_of_parents(const ExchangeAreas& raw, const NestedMesh& mesh, const SolvedProblem& solved,
                                   const EffectsOf& of);

/// The same for sampling errors: per parent the sum over its patches c and all patches i of A_i w_i^2 (rho_i D_ic
/// B_c / A_i)^2, relative to the square of the area norm of B - E, all bands. A source that is cut into more patches
/// gets more samples.
Eigen::VectorXd noise_of_parents(const HalfDifferences& differences, const NestedMesh& mesh,
                                 const SolvedProblem& solved, const Eigen::VectorXd& weight);

/// The terms of relative_bar() for a bar on the irradiance, squared, per patch, worst band.
Eigen::VectorXd squares_of_patches(const SolvedProblem& solved, const FieldView& bar, const Eigen::VectorXd& weight);

/// The same per parent.
Eigen::VectorXd squares_of_parents(const NestedMesh& mesh, const SolvedProblem& solved, const FieldView& bar,
                                   const Eigen::VectorXd& weight);

/// The remaining share of the squared mesh error of a parent that is cut: halving the patches' size reduces the error
/// by 2^mesh_order.
inline const double mesh_error_left = std::pow(2.0, -2 * mesh_order);

/// The remaining share of a squared sampling error with four times the samples.
inline constexpr double noise_left = 0.25;

/// The aim of cutting parents.
struct CutGoal {
  double factor = 1;              ///< by which the error has to fall
  double left = mesh_error_left;  ///< the remaining share of the squared effect of a parent that is cut
  std::size_t least = 0;          ///< parents to cut, if any
  std::size_t most = std::numeric_limits<std::size_t>::max();
};

/// Marks the smallest set of parents whose cutting reduces the error by the factor, the most effective first. If
/// cutting all is not sufficient, marks those with nine tenths of the effect. The limits apply, but parents without
/// effect are never marked, and none is if the error need not fall.
std::vector<std::uint8_t> parents_to_cut(const Eigen::VectorXd& effects, const CutGoal& goal);

/// The importance of each patch for the light on the patches of `interest` (1 or 0 per patch): the solution of the
/// adjoint equation psi = interest + F R psi, worst band. As S is symmetric, F is its own adjoint in the area-weighted
/// norm; for rows of rays this holds up to their errors.
Eigen::VectorXd importance(const TransportOperator& transport, const RadiosityProblem& problem,
                           const Eigen::VectorXd& interest);

}  // namespace patchlight
