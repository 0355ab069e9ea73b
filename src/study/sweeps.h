#pragma once

#include "study/experiment.h"

#include <vector>

namespace patchlight {

/// The finest setting, solved to several tolerances on one matrix.
struct Tolerances {
  std::vector<Simulation> runs;  ///< from loose to tight; the last one is the finest setting
  Field exact;                   ///< radiosity, to a hundredth of the last tolerance
};

/// Solves to 0.1, 0.01, ... down to the tolerance of the request.
Tolerances solve_to_tolerances(const Experiment& experiment);

/// One quantity at a time. Sizes are swept with the usual samples, and with four times as many: there the error of the
/// mesh is seen to fall; that is the second sweep.
std::vector<StudySweep> competing_sweeps(const Experiment& experiment, const Reference& reference,
                                         const Tolerances& tolerances);

/// As `solve --accuracy` does it: patches and samples are refined from the coarsest mesh on until an accuracy is met,
/// as long as that takes no more than the patches of the finest size. Their meshes are cut from that of the
/// experiment's coarsest size.
std::vector<Simulation> solve_to_accuracies(const Experiment& experiment);

/// The solutions to accuracies as a sweep.
StudySweep adaptive_sweep(const std::vector<Simulation>& solved, const Reference& reference);

/// The estimators of form factors on a small mesh, which do not compete.
std::vector<StudySweep> estimator_sweeps(const Experiment& experiment, const Reference& reference);

}  // namespace patchlight
