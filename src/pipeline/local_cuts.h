#pragma once

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "pipeline/run.h"

#include <optional>
#include <vector>

namespace patchlight {

/// A safety factor on error goals, because errors are estimates.
inline constexpr double error_margin = 1.25;

/// The largest useful number of shadow rays per pair, or of rays per patch.
int most_samples(const Plan& plan);

/// The number of patches for which the mesh error is expected to be `factor` times smaller.
double patches_for(double patches, double factor);

/// The factor by which the mesh error has to fall to reach `accuracy`. The mesh error includes the noise of shadow rays
/// towards luminaires, sun and sky, whose number per patch is fixed. `step` has the errors of the solved mesh.
double mesh_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy);

/// The factor by which the sampling noise has to fall.
double noise_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy);

/// The samples per pair for the next mesh. Noise falls as one over the root of samples and patches, so the number fits
/// the patches that the final mesh needs. The plan's number stays while the final mesh is far off, and where the next
/// mesh uses rays.
int samples_for(const SolvedMesh& solved, const AccuracyStep& step, double accuracy, const Plan& plan);

/// The largest number of cuts of a patch from one mesh to the next.
inline constexpr int most_local_cuts = 3;

/// The aim of local_cuts(), and the allowed growth in one step.
struct LocalGoal {
  double error = 0;
  double new_patches = 0;
  double more_to_lights = 0;
  double more_of_rows = 0;
  bool cuts_lamps = false;  ///< emitting patches may be cut, too
};

/// A mesh with some patches cut, and some rays doubled.
struct LocalCuts {
  FinerMesh mesh;
  std::vector<PatchIndex> light_place;  ///< Known::light_place
  MoreRays more_rays;
  double gain = 0;       ///< the expected decrease of the square of the error
  bool changes = false;  ///< anything is cut or doubled
};

/// The fewest cuts and doublings that are expected to reach the goal, starting where patches have the largest errors.
/// Uses the full allowed growth if the goal is out of reach.
LocalCuts local_cuts(const SolvedMesh& solved, const AccuracyStep& errors, const LocalGoal& goal);

/// The mean number of hemisphere rays per patch of that mesh, as a multiple of the plan's number.
double times_the_rays(const LocalCuts& cuts);

/// The mesh of `cuts`, ready to be solved like the previous one. Reuses its light where it is known.
MeshToSolve mesh_with(LocalCuts cuts, SolvedMesh& solved);

/// True when AccuracyOptions::local_cuts applies to the plan, for a first mesh of `patches` patches.
bool makes_second_mesh(const Plan& plan, PatchIndex patches);
bool makes_second_mesh(const Run& run, PatchIndex patches);

/// True when patches of a ray solution may be cut and rays doubled: during refinement to an accuracy, and where a
/// second mesh is allowed.
bool cuts_locally(const Run& run, PatchIndex patches);

/// The second mesh of a ray run.
struct SecondMesh {
  std::optional<MeshToSolve> mesh;  ///< empty: the first mesh is final
  Diagnostics notes;                ///< for Simulation::notes: the second mesh is made, or memory forbids it
};

/// The mesh after the first one, by local_cuts(). Moves the known light of other patches out of `solved`. Empty where
/// the error is small, where the gain is below a third of it, or where the mesh would not fit into memory.
SecondMesh second_mesh(const Run& run, SolvedMesh& solved, const AccuracyStep& errors);

/// Adds a note to the plan if a second mesh is allowed, but does not fit into memory even with no more patches than the
/// first.
Plan with_note_on_second_mesh(Plan plan, PatchIndex patches);

}  // namespace patchlight
