#pragma once

#include "pipeline/mesh_transport.h"
#include "pipeline/run.h"

namespace patchlight {

/// The solved mesh with error bars, and where finer patches would pay; without, where the plan wants none. \throws
/// InputError when nothing of the plan's interest is there or reflects light.
SolvedMesh with_error_bars(const Run& run, SolvedMesh result, MeshTransport transport);

/// The share of the patches that emit.
double share_of_lamps(const RadiosityProblem& problem);

}  // namespace patchlight
