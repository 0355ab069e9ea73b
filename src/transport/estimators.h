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

/// A sample with uniformly distributed points on both patches: weight A_i A_j G.
PairSample draw_by_area(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at);

// What assemble_exchange_areas() does for Estimator::area and so on. Each is plain: no clusters, no short cuts.

/// S = A_i A_j mean(G V) over pairs of points, uniform on both patches. No finite variance for patches that touch.
Assembly estimate_by_area(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                          const Observer& observer);

/// S = A_i mean(F(x)) - A_i mean(w (1 - V)) over points x of the smaller patch: F is the exact form factor from x to
/// the larger one, w the weight of a ray to a point chosen in its solid angle. Where most weight is blocked A_i mean(w
/// V).
Assembly estimate_by_points(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer);

/// S = (A_i n_ij + A_j n_ji) / (2 s) with n_ij of s cosine-distributed rays from patch i arriving at patch j first.
Assembly estimate_by_hemisphere(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                const Observer& observer);

/// S = U sum(G V) / sum(G): the contour integral U times the visible share of the samples of estimate_by_area().
Assembly estimate_by_contour(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                             const Observer& observer);

}  // namespace patchlight
