#pragma once

#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <vector>

namespace patchlight {

/// 1 for each patch whose errors count, else 0: those of what the plan names as of interest. Where it names nothing,
/// by daylight those that are enclosed, as long as light gets there; else all.
Eigen::VectorXd interest_in(const Scene& scene, const Simulation& simulation);

/// The errors inside and outside, by the error bars; empty where what is of interest is on one side.
std::vector<SpaceErrors> errors_by_space(const Scene& scene, const Simulation& simulation);

/// The relative errors of the patches that `weight` counts. Seconds are left open.
AccuracyStep errors_of(const Simulation& simulation, const Eigen::VectorXd& weight);

/// What may be wrong with the radiosities of a solution, for gathering them, W/m^2: its error bars where it has any.
/// Otherwise the errors of sampling are taken from how far the row sums were off before closure, and those of the mesh
/// are not known.
RadiosityErrors radiosity_errors(const Simulation& simulation);

}  // namespace patchlight
