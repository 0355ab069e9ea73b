#pragma once

#include "pipeline/run.h"

#include <optional>
#include <string>

namespace patchlight {

/// True when AccuracyOptions::local_cuts holds for the plan, and for a run with a first mesh of so many patches.
bool makes_second_mesh(const Plan& plan, PatchIndex patches);
bool makes_second_mesh(const Run& run, PatchIndex patches);

/// True where patches of a solution by rows of rays may be cut, and rays of some doubled: on the way to an accuracy,
/// and where there may be a second mesh.
bool cuts_locally(const Run& run, PatchIndex patches);

/// The mesh after the first one of such a run, by local_cuts(). What is known of the light on other patches is taken
/// from `solved`. None where the error is small, where that would not take a third of it away, or where it would not
/// fit into the memory.
std::optional<MeshToSolve> second_mesh(const Run& run, SolvedMesh& solved, const AccuracyStep& errors);

/// What was done, for Simulation::notes.
std::string note_on_second_mesh(const MeshToSolve& next, const AccuracyStep& errors);

}  // namespace patchlight
