#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/transport/lost_share.h"

namespace patchlight {

/// Where the light of a solution goes. `row_sum` is sum_j F_ij of the transport that was solved with.
EnergyBalance energy_balance(const RadiosityProblem& problem, const Solution& solution, const Eigen::VectorXd& row_sum,
                             const LostShare& lost);

}  // namespace patchlight
