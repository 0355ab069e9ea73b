#pragma once

#include "pipeline/run.h"

#include <cstdint>
#include <optional>
#include <string>

namespace patchlight {

/// A patch is cut so often at most.
inline constexpr int most_local_cuts = 3;

/// With the run's seed that of the rays on the second mesh.
inline constexpr std::uint64_t seed_of_second_mesh = 0x2d5;

/// True when AccuracyOptions::local_cuts holds for the plan, and for a run with a first mesh of so many patches.
bool cuts_locally(const Plan& plan, PatchIndex patches);
bool cuts_locally(const Run& run, PatchIndex patches);

/// The mesh after the first one of such a run: some of its patches are cut, some of them several times, and rays of
/// some are doubled, so that much less of the error is left. What is known of the light on other patches is taken from
/// `solved`. None where the error is small, where that would not take a third of it away, or where it would not fit
/// into the memory.
std::optional<MeshToSolve> with_local_cuts(const Run& run, SolvedMesh& solved, const AccuracyStep& errors);

/// What was done, for Simulation::notes.
std::string note_on_local_cuts(const MeshToSolve& next, const AccuracyStep& errors);

}  // namespace patchlight
