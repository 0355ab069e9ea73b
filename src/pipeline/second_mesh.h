#pragma once

#include "pipeline/run.h"

#include <optional>

namespace patchlight {

/// True when AccuracyOptions::local_cuts holds for the plan, and for a run with a first mesh of so many patches.
bool makes_second_mesh(const Plan& plan, PatchIndex patches);
bool makes_second_mesh(const Run& run, PatchIndex patches);

/// True where patches of a solution by rows of rays may be cut, and rays of some doubled: on the way to an accuracy,
/// and where there may be a second mesh.
bool cuts_locally(const Run& run, PatchIndex patches);

/// What a run by rays does after its first mesh.
struct SecondMesh {
  std::optional<MeshToSolve> mesh;  ///< none: the first one is all
  Diagnostics notes;                ///< that it is done, or why memory forbids it, for Simulation::notes
};

/// The mesh after the first one of such a run, by local_cuts(). What is known of the light on other patches is taken
/// from `solved`. None where the error is small, where that would not take a third of it away, or where it would not
/// fit into the memory.
SecondMesh second_mesh(const Run& run, SolvedMesh& solved, const AccuracyStep& errors);

/// A plan with a note where a second mesh may be made after a first one of so many patches, but not even one with as
/// many fits into the memory beside it.
Plan with_note_on_second_mesh(Plan plan, PatchIndex patches);

}  // namespace patchlight
