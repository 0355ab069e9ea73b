#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

namespace patchlight {

/// The spectral radius of K = rho o F, per band, from below: ||G w|| / ||w|| of the power iteration for the symmetric
/// matrix G that is similar to it, from equal irradiance everywhere. It never falls, and its error falls by the square
/// of the ratio of the two largest sizes of eigenvalues with each of the `steps` applications. 0 where nothing is
/// reflected.
Eigen::ArrayXd spectral_radius(const TransportOperator& transport, const RadiosityProblem& problem, int steps);

}  // namespace patchlight
