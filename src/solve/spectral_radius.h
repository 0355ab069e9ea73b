#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

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

}  // namespace patchlight
