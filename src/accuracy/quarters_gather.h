#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "accuracy/unseen_differences.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Rays from a quarter of a patch over the hemisphere.
inline constexpr std::size_t rays_per_quarter = 16;

/// What the rays of all quarters tell.
struct GatheredQuarters {
  Field irradiance;  ///< per quarter: mean over what is exposed of it, without luminaires, sun and sky, W/m^2
  std::vector<PatchIndex> met;  ///< per quarter and ray: the quarter that it meets, or no_patch
  Eigen::ArrayXd exposed;       ///< per quarter: what of its area no solid covers, m^2
  Eigen::ArrayXd seen;          ///< per quarter: the share of its hemisphere in which there are patches
};

/// Gathers light at the quarters of patches from a solution on the patches: along cosine-distributed rays what is
/// reflected, along as many shadow rays what lamps emit. The quarters of a patch take the same directions, so that
/// little noise is in their differences. `seed` chooses the rays. \throws Cancelled.
GatheredQuarters gather_at_quarters(const QuarteredMesh& mesh, const Occluder& occluder, const SolvedProblem& solved,
                                    std::uint64_t seed, const Observer& observer);

}  // namespace patchlight
