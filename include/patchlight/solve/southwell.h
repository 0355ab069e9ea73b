#pragma once

#include "patchlight/solve/solve.h"

namespace patchlight {

/// Progressive refinement: the patch with the most unshot flux shoots it to all others, again and again. Cohen, Chen,
/// Wallace and Greenberg 1988; it is Southwell relaxation of the same system (Gortler, Cohen and Slusallek 1994).
Solution progressive_refinement(const RowTransport& transport, const RadiosityProblem& problem,
                                const SolverOptions& options, const Observer& observer);

}  // namespace patchlight
