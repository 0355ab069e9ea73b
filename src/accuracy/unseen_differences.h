#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "accuracy/quarters_gather.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace patchlight {

/// How the quarters of patches are looked at.
struct QuarterLook {
  int rays = 16;  ///< from each over the hemisphere, and as many towards lamps, in each half; a power of two
  std::uint64_t seed = 1;
  std::array<Field, 2> direct = {};  ///< per quarter: irradiance by luminaires, sun and sky, W/m^2, found twice with
                                     ///< other rays; empty without these
};

/// What is behind the means of patches: light that differs inside a patch gets to others from the part that they see.
/// Under a board close over a floor it is dark, however bright the mean of a patch that reaches under it.
struct UnseenDifferences {
  Field error;  ///< of the mean irradiance of each patch, W/m^2
  Field noise;  ///< of which the square is what noise adds to that of the error, as far as sums over many patches tell,
                ///< W/m^2: more than the error where nothing but noise is known
  Field display;            ///< how far the irradiance at a point of a patch is from its mean, root mean square, W/m^2
  Eigen::VectorXd effects;  ///< per patch: the part of its differences in the weighted squares of what all change, to
                            ///< a factor; noise may make it negative
};

/// Found by rays: the irradiance of each quarter is gathered from the patches, its difference from the mean of its
/// patch is gathered again along the same rays, and that is followed through all reflections. What is inside the
/// quarters is extrapolated (mesh_order). All this twice, with other rays: the product of the two has no bias by their
/// noise, and its mean over the patches around has less of it. `weight` is that of each patch in the error. O(size)
/// rays. \throws Cancelled.
UnseenDifferences unseen_differences(const SolvedPatches& patches, const TransportOperator& transport,
                                     const Eigen::VectorXd& weight, const QuarterLook& look, const Observer& observer);

}  // namespace patchlight
