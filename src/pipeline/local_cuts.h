#pragma once

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "pipeline/run.h"

#include <optional>
#include <vector>

namespace patchlight {

/// Errors are brought this much lower than they have to be, as they are estimates.
inline constexpr double error_margin = 1.25;

/// Shadow rays of a pair, or rays of a patch, more than which are not worth their time.
int most_samples(const Plan& plan);

/// The number of patches for which the mesh error is expected to be `factor` times smaller.
double patches_for(double patches, double factor);

/// By what factor the error of the mesh has to fall for an accuracy, and that of shadow rays towards luminaires, sun
/// and sky, which are as many for every patch. `step` has the errors of the solved mesh.
double mesh_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy);

/// The factor by which the noise of samples has to fall.
double noise_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy);

/// The samples that the next mesh takes for its pairs. Noise falls as one over the root of samples and patches: samples
/// for those patches that the mesh will need. As long as that is far off, the usual number does; and where the next
/// mesh goes by rows of rays.
int samples_for(const SolvedMesh& solved, const AccuracyStep& step, double accuracy, const Plan& plan);

/// A patch is cut so often at most from one mesh to the next.
inline constexpr int most_local_cuts = 3;

/// The error that may be left, relative as AccuracyStep, and by how much a mesh may grow at once for it, as a share of
/// its patches, and then the rays of each kind, as shares of those that the patches of the finer mesh would take.
struct LocalGoal {
  double error = 0;
  double new_patches = 0;
  double more_to_lights = 0;
  double more_of_rows = 0;
  bool cuts_lamps = false;  ///< patches that emit are cut as well
};

/// A mesh some of whose patches are cut, and rays of some doubled.
struct LocalCuts {
  FinerMesh mesh;
  std::vector<PatchIndex> light_place;  ///< Known::light_place
  MoreRays more_rays;
  double gain = 0;       ///< the expected decrease of the square of the error
  bool changes = false;  ///< anything is cut or doubled
};

/// The fewest cuts and doublings that are expected to leave the error, where patches err most; as many as may be where
/// these do not suffice.
LocalCuts local_cuts(const SolvedMesh& solved, const AccuracyStep& errors, const LocalGoal& goal);

/// The rays over the hemisphere of a patch of that mesh in the mean, in those of the plan.
double times_the_rays(const LocalCuts& cuts);

/// That mesh, to be solved as the one before was, whose light is taken over where it is known.
MeshToSolve mesh_with(LocalCuts cuts, SolvedMesh& solved);

/// True when AccuracyOptions::local_cuts holds for the plan, and for a run with a first mesh of so many patches.
bool makes_second_mesh(const Plan& plan, PatchIndex patches);
bool makes_second_mesh(const Run& run, PatchIndex patches);

/// True where patches of a solution by rows of rays may be cut, and rays of some doubled: on the way to an accuracy,
/// and where there may be a second mesh.
bool cuts_locally(const Run& run, PatchIndex patches);

/// The next step of a run by rays after its first mesh.
struct SecondMesh {
  std::optional<MeshToSolve> mesh;  ///< none: the first one is all
  Diagnostics notes;                ///< that it is done, or why memory forbids it, for Simulation::notes
};

/// The mesh after the first one of such a run, by local_cuts(). Takes the known light on other patches from `solved`.
/// None where the error is small, where that would not take a third of it away, or where it would not
/// fit into the memory.
SecondMesh second_mesh(const Run& run, SolvedMesh& solved, const AccuracyStep& errors);

/// A plan with a note where a second mesh may be made after a first one of so many patches, but not even one with as
/// many fits into the memory beside it.
Plan with_note_on_second_mesh(Plan plan, PatchIndex patches);

}  // namespace patchlight
