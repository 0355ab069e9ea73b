#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/visibility/occluder.h"

#include <Eigen/Core>
#include <cstdint>

namespace patchlight {

/// Per patch, the share of its cosine-weighted hemisphere from which no patch can be seen.
struct LostShare {
  Eigen::VectorXd escaped;   ///< rays that meet nothing
  Eigen::VectorXd at_backs;  ///< rays that meet a side without patches
  int rays_per_patch = 0;

  /// True when no ray of any patch was lost.
  bool closed() const { return escaped.sum() + at_backs.sum() == 0; }
};

/// Measures the lost shares with stratified cosine-hemisphere rays that start spread over each patch.
/// \throws Cancelled.
LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, int rays_per_patch, std::uint64_t seed,
                             const Observer& observer = {});

}  // namespace patchlight
