#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

namespace patchlight {

/// R of B = E + R H: how patches scatter the light that arrives, evenly. (R H)_i = rho_i H_i + t_i H_j, j the patch on
/// the other side of a translucent sheet. R is its own adjoint in the inner product sum_i A_i x_i y_i: A_i t_i = A_j
/// t_j.
struct Scattering {
  Field reflectance;                     ///< rho, in [0, 1]: one row per patch, one column per band
  std::vector<PatchIndex> other_side{};  ///< per patch the one on the other side of its sheet; itself, with t = 0,
                                         ///< where there is none; empty where there are no sheets
  Field transmittance{};  ///< t, the share of light that leaves the other side, rho + t <= 1; empty where
                          ///< there are no sheets

  /// False where there are sheets: then R is not diagonal.
  bool is_diagonal() const { return other_side.empty(); }

  /// R H: the radiosity by an irradiance, both in W/m^2.
  Field reflect(const Field& irradiance) const;
  /// The adjoint of R in the inner product sum_i A_i x_i y_i, applied to a field.
  Field adjoint(const Field& radiosity) const;
  /// Per band a bound on ||R H||_A / ||H||_A.
  Eigen::ArrayXd norm_bound() const;
};

/// B = E + R H, H = F B + H_direct: one row per patch, one column per band.
struct RadiosityProblem {
  Scattering scattering;      ///< R
  Field exitance;             ///< E, W/m^2
  Eigen::VectorXd area;       ///< m^2, the exposed part of each patch
  Field direct_irradiance{};  ///< H_direct, W/m^2: by light that comes from no patch; empty: none
};

/// B = E + R H for any irradiance H, W/m^2.
Field radiosity_from(const RadiosityProblem& problem, const Field& irradiance);

/// The radiosity of patches before any exchange between patches: E + R H_direct, W/m^2.
Field source_radiosity(const RadiosityProblem& problem);

/// The light that a solver has found, and how good it is.
struct Solution {
  Field radiosity;          ///< B, W/m^2; B = E + R H
  Field irradiance;         ///< H, W/m^2
  Field direct_irradiance;  ///< F E + H_direct, W/m^2: the part of H that comes straight from the lamps
  Field ambient;  ///< progressive refinement's estimate of the irradiance still under way, for display; else empty
  std::vector<Iteration> history;  ///< from iteration 0
  bool converged = false;
  bool stopped = false;  ///< by the observer, with SolverOptions::keeps_unfinished: the last iterate
  std::string
      trapped;  ///< light that can neither leave nor be absorbed: why the system is singular; empty if it is not
  Field error;  ///< per-patch bound on the error of `radiosity`, W/m^2; empty where none is known
  double patch_bound = std::numeric_limits<double>::infinity();  ///< ||error||_A / ||B - E||_A, worst band
};

/// Where the light goes, in W per band. emitted + arriving = absorbed + escaped + lost_at_backs + defect + imbalance.
struct EnergyBalance {
  Eigen::ArrayXd emitted;   ///< by patches
  Eigen::ArrayXd arriving;  ///< straight from luminaires, sun and sky
  Eigen::ArrayXd absorbed;
  Eigen::ArrayXd escaped;        ///< into the open
  Eigen::ArrayXd lost_at_backs;  ///< to sides without patches
  Eigen::ArrayXd defect;         ///< row sums that differ from the measured lost share: the form factors' error
  double imbalance = 0;          ///< relative to emitted + arriving, worst band: the solver's error
};

/// ||x||_A = sqrt(sum_i A_i x_i^2) per band.
Eigen::ArrayXd area_norm(const FieldView& x, const Eigen::VectorXd& area);

/// The relative error of a radiosity: ||B_ref - B||_A / ||B_ref - E||_A in the worst band. Neither norm includes the
/// light that lamps emit. 0 without a difference, infinite if B_ref = E and B differs. NaN propagates.
double relative_error(const FieldView& reference, const FieldView& radiosity, const RadiosityProblem& problem);

}  // namespace patchlight
