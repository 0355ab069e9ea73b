#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

class Occluder;

/// Shares of each patch's surroundings as seen by rays, per patch and in [0, 1].
struct LostShare {
  Eigen::VectorXd escaped;   ///< share of the exposed part's cosine-weighted hemisphere in which rays hit nothing
  Eigen::VectorXd at_backs;  ///< share of it in which rays hit a side without patches
  Eigen::VectorXd covered;   ///< share of the area that sees nothing else: inside a solid, or against a face
  int rays_per_patch = 0;
  Eigen::VectorXd dark = {};   ///< share of the exposed part that sees mostly sides without patches, e.g. the part of a
                               ///< patch inside a solid; empty if not measured
  Eigen::VectorXd clear = {};  ///< share of the arriving light that passes straight through the patch; empty: 0 for all

  /// Share of the area, part of `covered`, under another polygon in the patch's plane; empty: 0 for all.
  Eigen::VectorXd overlaid = {};
  std::vector<std::uint8_t> doublings = {};  ///< per patch: how many times rays_per_patch are doubled; empty: 0

  /// True when no ray of any patch was lost.
  bool closed() const { return escaped.sum() + at_backs.sum() == 0; }
};

/// LostShare::rays_per_patch with its doublings, for each of `patches` patches.
Eigen::ArrayXd rays_of_patches(const LostShare& lost, PatchIndex patches);

/// LostShare::clear.
Eigen::VectorXd clear_shares(const PatchMesh& mesh, const Occluder& occluder);

/// The factor that turns a mean over a patch without its overlaid part into a mean over its exposed part. No light
/// arrives at the rest, under objects that stand on the patch. The factor is 1 if no ray has found an exposed part:
/// then the arriving light is spread over all of it.
Eigen::ArrayXd over_exposed_part(const PatchMesh& mesh, const LostShare& lost, const Eigen::VectorXd& exposed_area);

/// The sum that each row of form factors should have: 1 - escaped - at_backs.
Eigen::VectorXd expected_row_sum(const LostShare& lost);

/// Measures the shares with stratified cosine-hemisphere rays that start spread over each patch. A ray that hits
/// nothing is traced again from a place 1 % nearer to the patch's centroid and slightly behind its plane. So cracks
/// between polygons, and faces in contact, do not count as openings. Where rays from one point hit backs, a face with
/// another face against it counts as a back, too. \throws Canceled.
LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, int rays_per_patch, std::uint64_t seed,
                             const Observer& observer = {});

/// Known shares of some patches, from another mesh of the same scene.
struct KnownShares {
  const LostShare& lost;
  const std::vector<PatchIndex>& place;  ///< per patch of the new mesh: the same patch in the other mesh, or no_patch
  bool ends_at_specular = false;         ///< rays end at clear polygons and mirrors, too
  bool sees_backs = false;  ///< all other patches are known to see backs, so no rays test this first. Small ones,
                            ///< small_area(), use a quarter of the rays if these find nothing covered
  std::span<const std::uint8_t> doublings = {};  ///< LostShare::doublings of the new mesh
};

/// The same bits, for the same number of rays, without tracing the rays of known patches.
LostShare measure_lost_share(const PatchMesh& mesh, const Occluder& occluder, const KnownShares& known,
                             std::uint64_t seed, const Observer& observer = {});

/// The area in m^2 that exchanges light: the part that is not covered, times the share that a clear patch holds back.
/// It is at least the visible area that the exchange areas S_ij imply (`seen`, their row sums in m^2), and at least
/// 1e-6 of the patch.
Eigen::VectorXd exposed_area(const PatchMesh& mesh, const LostShare& lost, const Eigen::VectorXd& seen);

}  // namespace patchlight
