#pragma once

#include "patchlight/transport/transport_operator.h"

#include "accuracy/needed_bands.h"
#include "accuracy/unseen_differences.h"
#include "pipeline/run.h"

namespace patchlight {

/// unseen_differences() of a simulation, those of the light of luminaires, sun and sky among them, in all bands;
/// `needed` is the simulation in those that differ, and `rays` start at each quarter of a patch in each half.
/// \throws Cancelled.
UnseenDifferences unseen_differences_of(const Run& run, const Simulation& simulation, const InNeededBands& needed,
                                        const TransportOperator& transport, const Eigen::VectorXd& weight, int rays);

}  // namespace patchlight
