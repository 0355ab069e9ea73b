#pragma once

#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <vector>

namespace patchlight {

/// The errors inside and outside, by the error bars; empty where no shells with openings divide what is of interest.
std::vector<SpaceErrors> errors_by_space(const Scene& scene, const Simulation& simulation);

/// The relative errors of the patches that `weight` counts. Seconds are left open.
AccuracyStep errors_of(const Simulation& simulation, const Eigen::VectorXd& weight);

}  // namespace patchlight
