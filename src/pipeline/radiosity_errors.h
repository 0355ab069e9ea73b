#pragma once

#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <vector>

namespace patchlight {

/// 1 for each patch whose errors count, else 0: the patches of interest in the plan. The default is the enclosed
/// patches by daylight, if light reaches them; otherwise all patches.
Eigen::VectorXd interest_in(const Scene& scene, const Simulation& simulation);

/// The errors inside and outside, from the error bars; empty if all patches of interest are on one side.
std::vector<SpaceErrors> errors_by_space(const Scene& scene, const Simulation& simulation);

/// The relative errors of the patches with a `weight`. Seconds are not set.
AccuracyStep errors_of(const Simulation& simulation, const Eigen::VectorXd& weight);

/// Errors of the radiosities for a gather, W/m^2: the error bars if there are any. Otherwise sampling errors follow
/// from the defects of the row sums before closure, and mesh errors are unknown.
RadiosityErrors radiosity_errors(const Simulation& simulation);

}  // namespace patchlight
