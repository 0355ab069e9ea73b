#pragma once

#include "study/reference.h"
#include "study/study.h"

namespace patchlight {

/// The parts of the finest setting's error: form factors and solver by the own errors of that setting in the sweeps of
/// samples and of tolerances, the mesh what is left of its error.
ErrorParts error_parts(const Scene& scene, const Simulation& finest, const Discrepancy& discrepancy,
                       const std::vector<StudySweep>& sweeps);

}  // namespace patchlight
