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

/// By so many steps of Lanczos for the symmetric matrix G that is similar to K, from equal irradiance everywhere. Where
/// sheets scatter light to their other sides, by the power iteration ||G w|| / ||w||. Neither falls with the steps. The
/// value is 0 where nothing is reflected. Each step applies the transport once.
SpectralRadius spectral_radius_with_error(const TransportOperator& transport, const RadiosityProblem& problem,
                                          int steps);

/// The value alone.
Eigen::ArrayXd spectral_radius(const TransportOperator& transport, const RadiosityProblem& problem, int steps);

/// Stands for a bound that is not known.
inline constexpr double no_bound = std::numeric_limits<double>::infinity();

/// A row that lacks less to 1 loses no light: closure and rounding leave so much.
inline constexpr double least_escape = 1e-6;

/// Row sums are known to about 1e-9. With ||K||_A above this no error is known, and a surface that reflects more counts
/// as one that absorbs nothing.
inline constexpr double largest_contraction = 1 - 1e-8;

/// Positive weights v with g = v - K v > 0: for any non-negative K, |B* - B|_i <= v_i max_j |r_j| / g_j. One column per
/// band.
struct PatchWeights {
  Field v;
  Field g;
  int applications = 0;  ///< that finding them took
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

/// Weights from a loose solution of (I - K) v = 1. Nothing when g is not positive where the search is given up: then no
/// bound is known. Costs some three to five applications. Of more than three bands v is that of the largest R of each
/// patch, in one column, which bounds the errors of every band; each has its own only where that one does not contract.
std::optional<PatchWeights> patch_weights(const TransportOperator& transport, const RadiosityProblem& problem);

/// Per patch and band a bound on the error of E + rho o F B, W/m^2, for the residual r of B: (K |B* - B|)_i <=
/// (v_i - g_i) max_j |r_j| / g_j.
Field patch_errors(const PatchWeights& weights, const FieldView& residual);

/// Bands in which light is emitted where it can neither leave nor be absorbed: patches that reflect all of it, see
/// nothing but each other and lose nothing. A sentence for the user; empty when there are none. Costs a few
/// applications where some patch reflects all light, else nothing.
std::string trapped_light(const TransportOperator& transport, const RadiosityProblem& problem);

}  // namespace patchlight
