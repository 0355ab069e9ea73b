#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "accuracy/errors.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace patchlight {

class Occluder;

/// Patches and their quarters: patch i has the quarters 4 i to 4 i + 3.
struct QuarteredMesh {
  const PatchMesh& whole;
  const Eigen::VectorXd& covered;  ///< the share of each patch that solids cover, LostShare::covered
  PatchMesh quarters;
  std::array<Field, 2> direct = {};  ///< per quarter: irradiance by luminaires, sun and sky, W/m^2, found twice with
                                     ///< other rays; empty without these
};

/// What is behind the means of patches: light that differs inside a patch gets to others from the part that they see.
/// Under a board close over a floor it is dark, however bright the mean of a patch that reaches under it.
struct UnseenDifferences {
  Field error;              ///< of the mean irradiance of each patch, W/m^2
  Eigen::VectorXd effects;  ///< per patch: of its differences on all others, as effects_of_parents() counts
};

/// Found by rays: the irradiance of each quarter is gathered from the patches, its difference from the mean of its
/// patch is gathered again along the same rays, and that is followed through all reflections. What is inside the
/// quarters is extrapolated (mesh_order). All this twice, with other rays: the product of the two has no bias by their
/// noise, and its mean over the patches around has less of it. `weight` is that of each patch in the error. O(size)
/// rays. \throws Cancelled.
UnseenDifferences unseen_differences(const QuarteredMesh& mesh, const Occluder& occluder, const RowTransport& transport,
                                     const SolvedProblem& solved, const Eigen::VectorXd& weight, std::uint64_t seed,
                                     const Observer& observer);

}  // namespace patchlight
