#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"

#include "visibility/occluder.h"

namespace patchlight {

/// Processor seconds that assemble_exchange_areas() is expected to take with the automatic estimator: those of some
/// hundred pairs of clusters, chosen at random, times the number of all. Takes a tenth of a second or less.
double expected_assembly_seconds(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options);

}  // namespace patchlight
