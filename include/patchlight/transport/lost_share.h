#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

class Occluder;

/// Shares of each patch's surroundings as rays see them, all per patch and in [0, 1].
struct LostShare {
  Eigen::VectorXd escaped;   ///< share of the exposed part's cosine-weighted hemisphere in which nothing is met
  Eigen::VectorXd at_backs;  ///< share of it in which a side without patches is met
  Eigen::VectorXd
      covered;  ///< share of the area from which nothing else can be seen: inside a solid, or against a face
  int rays_per_patch = 0;
  Eigen::VectorXd dark = {};  ///< share of the exposed part from where mostly sides without patches are seen: of a
                              ///< patch that reaches into a solid it is the part inside; empty when it was not measured
  Eigen::VectorXd clear = {};  ///< share of what arrives at the patch that goes straight through; empty: none of any

  Eigen::VectorXd overlaid = {};  ///< share of the area, part of `covered`, over which another polygon lies in the
                                  ///< patch's plane; empty: none of any
  std::vector<std::uint8_t> doublings = {};  ///< how often rays_per_patch are doubled for the patch; empty: never

  /// True when no ray of any patch was lost.
  bool closed() const { return escaped.sum() + at_backs.sum() == 0; }
};

/// LostShare::rays_per_patch with their doublings, for each of so many patches.
Eigen::ArrayXd rays_of_patches(const LostShare& lost, PatchIndex patches);

/// LostShare::clear.
Eigen::VectorXd clear_shares(const PatchMesh& mesh, const Occluder& occluder);

/// By how much a mean over all of a patch but what is overlaid becomes one over its exposed part, when nothing arrives
/// at the rest: under what stands on the patch. 1 where no ray has found a part that is exposed: what arrives there is
/// spread over all of it.
Eigen::ArrayXd over_exposed_part(const PatchMesh& mesh, const LostShare& lost, const Eigen::VectorXd& exposed_area);

/// The sum that each row of form factors should have: 1 - escaped - at_backs.
Eigen::VectorXd expected_row_sum(const LostShare& lost);

/// Measures the shares with stratified cosine-hemisphere rays that start spread over each patch. A ray that meets
/// nothing is traced again from a place 1 % nearer to the patch's centroid and a little behind its plane, so that
/// cracks between polygons and faces that lie against each other do not count as openings. Where rays from one point
/// meet backs, a face counts as a back too if another lies against it. \throws Cancelled.
LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, int rays_per_patch, std::uint64_t seed,
                             const Observer& observer = {});

/// The shares of some patches that are known already, from another mesh of the same scene.
struct KnownShares {
  const LostShare& lost;
  const std::vector<PatchIndex>&
      place;                      ///< of each patch of the new mesh: the same patch in the other one, or no_patch
  bool ends_at_specular = false;  ///< rays end at clear polygons and mirrors as at all others
  bool sees_backs = false;        ///< all others are known to see backs: no rays find that out first; and small ones,
                                  ///< small_area(), take a quarter of the rays where these find nothing covered
  std::span<const std::uint8_t> doublings = {};  ///< LostShare::doublings of the new mesh
};

/// The same bits, with as many rays, but without tracing those of patches that are known.
LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, const KnownShares& known,
                             std::uint64_t seed, const Observer& observer = {});

/// The area in m^2 that takes part in the exchange of light: what is not covered, times the share that a clear patch
/// holds back. It is never below what the exchange areas S_ij, given by their row sums in m^2, show to be seen of the
/// patch, nor below 1e-6 of it.
Eigen::VectorXd exposed_area(const PatchMesh& mesh, const LostShare& lost, const Eigen::VectorXd& seen);

}  // namespace patchlight
