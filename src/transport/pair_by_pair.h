#pragma once

#include "patchlight/transport/assemble.h"

#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <array>
#include <functional>

namespace patchlight {

/// A shadow ray between two patches.
struct PairSample {
  Point from;             ///< on the smaller patch
  Point to;               ///< on the larger
  double weight = 0;      ///< the mean of the weights of the free rays is the exchange area, m^2
  double unoccluded = 0;  ///< an estimate of the exchange area without occluders, m^2; 0 if it is not used
};

/// The sample that belongs to a point of the unit hypercube. The smaller patch comes first.
using DrawSample =
    std::function<PairSample(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at)>;

/// Means over the samples of a pair, m^2.
struct SampleMeans {
  double visible = 0;     ///< of weight V
  double blocked = 0;     ///< of weight (1 - V)
  double unoccluded = 0;  ///< of PairSample::unoccluded
};

/// The exchange area that follows, m^2.
using UseMeans = std::function<double(const PatchShape& smaller, const PatchShape& larger, const SampleMeans& means)>;

/// How the exchange area of a pair is found from options.samples shadow rays.
struct PairEstimator {
  DrawSample draw;
  UseMeans use;
};

/// Every pair of patches that face each other, one after the other. The points are scrambled Sobol sequences, one for
/// each pair. \throws Cancelled.
Assembly pair_by_pair(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                      const PairEstimator& estimator, const Observer& observer);

/// A sample with uniformly distributed points on both patches: weight A_i A_j G.
PairSample draw_by_area(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at);

}  // namespace patchlight
