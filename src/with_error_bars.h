#pragma once

#include "patchlight/simulate.h"
#include "patchlight/transport/closure.h"
#include "patchlight/transport/transport_operator.h"

#include "solve_mesh.h"

namespace patchlight {

/// The solved mesh with error bars, and where finer patches would pay. `of_parents` are the exchange areas of the
/// transport, summed up. \throws InputError when nothing of the plan's interest is there or reflects light.
SolvedMesh with_error_bars(const Setting& setting, SolvedMesh result, const RowTransport& transport,
                           ClosedExchangeAreas of_parents);

/// The share of the patches that emit.
double share_of_lamps(const RadiosityProblem& problem);

/// Lamps with a larger share are not traced a second time to learn the errors of their light.
inline constexpr double most_lamps = 0.125;

}  // namespace patchlight
