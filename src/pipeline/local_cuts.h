#pragma once

#include "accuracy/errors.h"
#include "mesh/nested_mesh.h"
#include "pipeline/run.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// A patch is cut so often at most from one mesh to the next.
inline constexpr int most_local_cuts = 3;

/// With the run's seed that of the rays on all meshes but the first.
inline constexpr std::uint64_t seed_of_later_meshes = 0x2d5;

/// True where patches of a solution by rows of rays may be cut, and rays of some doubled: on the way to an accuracy,
/// and where there may be a second mesh. `patches` is the number of the first mesh.
bool cuts_locally(const Plan& plan, PatchIndex patches);
bool cuts_locally(const Run& run, PatchIndex patches);

/// The error that may be left, relative as AccuracyStep, and by how much a mesh and its rays may grow at once for it,
/// as shares of all there are.
struct LocalGoal {
  double error = 0;
  double new_patches = 0;
  double more_to_lights = 0;
  double more_of_rows = 0;
};

/// A mesh some of whose patches are cut, and rays of some doubled.
struct LocalCuts {
  FinerMesh mesh;
  std::vector<PatchIndex> light_place;  ///< Known::light_place
  MoreRays more_rays;
  double more_of_rows = 0;  ///< the rays over the hemisphere that are new, as a share of all
  double gain = 0;          ///< what the square of the error is expected to lose
  bool changes = false;     ///< anything is cut or doubled
};

/// The fewest cuts and doublings that are expected to leave the error, where patches err most.
LocalCuts local_cuts(const SolvedMesh& solved, const AccuracyStep& errors, const LocalGoal& goal);

/// That mesh, to be solved as the one before was, whose light is taken over where it is known.
MeshToSolve mesh_with(LocalCuts cuts, SolvedMesh& solved);

}  // namespace patchlight
