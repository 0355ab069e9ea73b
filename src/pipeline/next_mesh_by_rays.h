#pragma once

#include "pipeline/run.h"

#include <limits>
#include <optional>
#include <span>

namespace patchlight {

/// What the meshes by rows of rays are made for.
struct RayGoal {
  double error = 0;                                        ///< relative, as AccuracyStep
  double times = std::numeric_limits<double>::infinity();  ///< how often the last mesh could be solved in the time that
                                                           ///< is left
};

/// The mesh after one by rows of rays, by local_cuts(); what is known of the light on other patches is taken from
/// `solved`. `steps` has the errors of all meshes until now. None where nothing more is gained, or fits into the time.
/// \throws MemoryError where there is time and the memory does not suffice.
std::optional<MeshToSolve> next_mesh_by_rays(SolvedMesh& solved, std::span<const AccuracyStep> steps,
                                             const RayGoal& goal);

}  // namespace patchlight
