#pragma once

#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <vector>

namespace patchlight {

/// Of a simulation with error bars; empty where shells with openings do not divide what is of interest.
std::vector<SpaceErrors> errors_by_space(const Scene& scene, const Simulation& simulation);

/// The relative errors of the patches that `weight` counts.
AccuracyStep errors_of(const Simulation& simulation, const Eigen::VectorXd& weight);

}  // namespace patchlight
