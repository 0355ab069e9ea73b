#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "accuracy/errors.h"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace patchlight {

class Occluder;

/// A solution on patches, and what stands between them.
struct SolvedPatches {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const LostShare& lost;
  const SolvedProblem& solved;
};

/// What the rays of all quarters tell: patch i has the quarters 4 i to 4 i + 3 (mesh/quarters.h).
struct GatheredQuarters {
  int rays = 0;      ///< from each quarter
  Field irradiance;  ///< per quarter: mean over what is exposed of it, without luminaires, sun and sky, W/m^2
  std::vector<PatchIndex> met;       ///< per quarter and ray: the quarter that it meets, or no_patch
  std::vector<std::uint8_t> is_far;  ///< likewise: 1 where the patch that it meets is_far_from() where it starts
  Eigen::ArrayXd part_of_ray;        ///< per quarter: what part of the mean over its patch one of its rays is
  Eigen::ArrayXd exposed;            ///< per quarter: what of its area no solid covers, m^2
  Eigen::ArrayXd seen;               ///< per quarter: the share of its hemisphere in which there are patches
  Eigen::ArrayXd open;               ///< per quarter: the share of it in which nothing is near, as is_far_from() has it
};

/// From so far away, a distance in metres, the quarters of a patch of this area look alike, but for what hides some.
inline bool is_far_from(double distance, double area) {
  constexpr double edges = 8;
  return distance * distance > edges * edges * area;
}

/// How many rays start at each quarter, a power of two, and what chooses them.
struct RaysOfQuarters {
  int rays = 16;
  std::uint64_t seed = 1;
};

/// Gathers light at the quarters of patches from a solution on the patches: along cosine-distributed rays what is
/// reflected, along as many shadow rays what lamps emit. The quarters of a patch take the same directions, so that
/// little noise is in their differences. \throws Cancelled.
GatheredQuarters gather_at_quarters(const SolvedPatches& patches, const RaysOfQuarters& rays, const Observer& observer);

}  // namespace patchlight
