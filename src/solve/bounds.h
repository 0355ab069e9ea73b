#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/solve/solve.h"
#include "patchlight/transport/transport_operator.h"

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>

namespace patchlight {

/// The spectral radius of K = rho o F, per band.
struct SpectralRadius {
  Eigen::ArrayXd value;  ///< from below, but for rounding
  Eigen::ArrayXd error;  ///< an eigenvalue lies within this of the value
};

/// Estimates the spectral radius by this many Lanczos steps for the symmetric matrix G that is similar to K, starting
/// from uniform irradiance. With translucent sheets, the power iteration ||G w|| / ||w|| replaces Lanczos. More steps
/// never lower the value. The value is 0 where nothing is reflected. Each step costs one application.
SpectralRadius spectral_radius_with_error(const TransportOperator& transport, const RadiosityProblem& problem,
                                          int steps);

/// The value alone.
Eigen::ArrayXd spectral_radius(const TransportOperator& transport, const RadiosityProblem& problem, int steps);

/// The value of an unknown bound.
inline constexpr double no_bound = std::numeric_limits<double>::infinity();

/// A row whose sum is within this of 1 loses no light: closure and rounding leave such differences.
inline constexpr double least_escape = 1e-6;

/// Row sums are accurate to about 1e-9. If ||K||_A is above this, the error is unknown, and a surface with a higher
/// reflectance counts as one that absorbs nothing.
inline constexpr double largest_contraction = 1 - 1e-8;

/// Positive weights v with g = v - K v > 0: for any non-negative K, |B* - B|_i <= v_i max_j |r_j| / g_j. One column per
/// band.
struct PatchWeights {
  Field v;
  Field g;
  int applications = 0;  ///< applications used to find the weights
};

/// Bounds on the error from the residual.
struct Bounds {
  Eigen::ArrayXd contraction;           ///< per band, a bound on ||K||_A; infinite when none is known
  std::optional<PatchWeights> weights;  ///< where the contraction is not below 1, if they exist

  /// True when a band contracts: ||B* - B||_A <= ||r||_A / (1 - contraction).
  bool contracts(Eigen::Index band) const;
  /// True when all do.
  bool contracts() const;
};

/// rho_max times the largest row sum, from `options` or one application.
/// docs/theory/solvers-and-bounds.md.
Eigen::ArrayXd contraction_of(const TransportOperator& transport, const RadiosityProblem& problem,
                              const SolverOptions& options);

/// Weights from a loose solution of (I - K) v = 1. Empty if the search stops before g is positive: then no bound is
/// known. Costs three to five applications. With more than three bands, v has a single column, from the largest R of
/// each patch, which bounds the errors of all bands. Each band has its own column only if the shared one does not
/// contract.
std::optional<PatchWeights> patch_weights(const TransportOperator& transport, const RadiosityProblem& problem);

/// Per patch and band a bound on the error of E + rho o F B, W/m^2, for the residual r of B: (K |B* - B|)_i <=
/// (v_i - g_i) max_j |r_j| / g_j.
Field patch_errors(const PatchWeights& weights, const FieldView& residual);

/// Bands in which a lamp emits light that can neither leave nor be absorbed. Its patches reflect all light, see only
/// each other and lose nothing. Returns a sentence for the user; empty if there is no such band. Costs a few
/// applications if some patch reflects all light, else nothing.
std::string trapped_light(const TransportOperator& transport, const RadiosityProblem& problem);

}  // namespace patchlight
