#pragma once

#include "patchlight/solve/solve.h"

#include "solve/pockets.h"

#include <Eigen/Core>
#include <array>

namespace patchlight {

/// What of the flux between patches gets lost, or is made, by the errors of rows: each row sums up to what its patch
/// sees, but the columns do not. By reciprocity sum_i A_i (F B)_i = sum_j A_j s_j B_j, with s_j the share of patch j's
/// hemisphere in which there are patches. What is missing is shared out as the light is that arrives from patches:
/// H = F B + shape (sum_j A_j s_j B_j - sum_i A_i (F B)_i). In a room of reflectance rho it would otherwise change the
/// level of the light 1 / (1 - rho) times as much.
struct ConservedFlux {
  Eigen::VectorXd seen_area;  ///< A_j s_j, m^2
  Field shape;                ///< of what is missing, 1/m^2: its mean times the area of all patches is 1, or 0

  /// F B with the flux that is missing; `gathered` is F B.
  Field completed(Field gathered, const Field& radiosity, const Eigen::VectorXd& area) const;
};

/// A solution and what it conserves. `solution` has the radiosity B of that; its irradiance is the one before.
struct ConservingSolution {
  Solution solution;
  ConservedFlux flux;
  std::array<Field, 2> gathered;  ///< F B by each half of the rays, W/m^2; F E of light that is not reflected twice
};

/// A solution B = E + R (F B + H_direct) made one that conserves flux, by the Sherman-Morrison formula: a second
/// solution, of `shape` reflected, tells what a missing watt changes. What its residual leaves of the second, an
/// estimate, is added to the error of the first. `row_sum` is s_j. Where one of both does not converge, the solution
/// stays as it is, and `shape` is 0. \throws Cancelled.
ConservingSolution conserving_flux(const RaysWithPockets& transport, const RadiosityProblem& problem, Solution solution,
                                   const Eigen::VectorXd& row_sum, const Observer& observer = {});

}  // namespace patchlight
