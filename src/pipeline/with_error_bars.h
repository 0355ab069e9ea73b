#pragma once

#include "pipeline/mesh_transport.h"
#include "pipeline/run.h"

namespace patchlight {

/// Adds error bars and the effects of finer patches to a solved mesh, if the plan has error bars. \throws InputError
/// when no patch of the plan's interest exists or reflects light.
SolvedMesh with_error_bars(const Run& run, SolvedMesh result, MeshTransport transport);

/// The fraction of patches that emit.
double share_of_emitters(const RadiosityProblem& problem);

}  // namespace patchlight
