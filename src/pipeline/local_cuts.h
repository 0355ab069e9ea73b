#pragma once

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "pipeline/run.h"

#include <vector>

namespace patchlight {

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
  double gain = 0;       ///< what the square of the error is expected to lose
  bool changes = false;  ///< anything is cut or doubled
};

/// The fewest cuts and doublings that are expected to leave the error, where patches err most; as many as may be where
/// these do not suffice.
LocalCuts local_cuts(const SolvedMesh& solved, const AccuracyStep& errors, const LocalGoal& goal);

/// The rays over the hemisphere of a patch of that mesh in the mean, in those of the plan.
double times_the_rays(const LocalCuts& cuts);

/// That mesh, to be solved as the one before was, whose light is taken over where it is known.
MeshToSolve mesh_with(LocalCuts cuts, SolvedMesh& solved);

}  // namespace patchlight
