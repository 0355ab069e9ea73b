#pragma once

#include "pipeline/run.h"

#include <optional>
#include <string>

namespace patchlight {

/// A patch is cut so often at most.
inline constexpr int most_local_cuts = 3;

/// Whether the run is of AccuracyOptions::local_cuts.
bool cuts_locally(const Run& run);

/// What comes after the first mesh of such a run: the same with patches cut, some of them several times, and rays of
/// patches doubled, where that leaves much less of the error; of light that is known the rest is kept. None where the
/// error is small enough already, where that would not pay, or where it would not fit into the memory.
std::optional<MeshToSolve> with_local_cuts(const Run& run, SolvedMesh& solved, const AccuracyStep& errors);

/// What was done, for Simulation::notes.
std::string note_on_local_cuts(const MeshToSolve& next, const AccuracyStep& errors);

}  // namespace patchlight
