#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "mesh/interpolate.h"
#include "visibility/occluder.h"

#include <Eigen/Core>
#include <span>
#include <vector>

namespace patchlight {

/// Planes through values of patches: how a value varies on a patch, from those of the patches around it.
class PlaneFits {
 public:
  /// Keeps references.
  PlaneFits(const PatchMesh& mesh, const Occluder& occluder) : mesh_(mesh), occluder_(occluder), at_vertex_(mesh) {}

  /// The patches of the same side of a polygon that share a vertex with a patch, in their order.
  std::vector<PatchIndex> patches_around(PatchIndex j) const;

  /// Those that nothing hides from this one, a tenth of their distance above the polygon.
  std::vector<PatchIndex> in_sight(PatchIndex j, std::span<const PatchIndex> others) const;

  /// A column a_i for each of these patches, 1/m: the gradient of the plane fitted by least squares is sum_i a_i (B_i -
  /// B_j). (sum d d^T) g = sum d (B_i - B_j), d the way from one centroid to the other, damped so that it is soluble
  /// where all patches lie in one direction. 0 without patches.
  Eigen::Matrix3Xd slopes(PatchIndex j, std::span<const PatchIndex> around) const;

 private:
  const PatchMesh& mesh_;
  const Occluder& occluder_;
  PatchesAtVertices at_vertex_;
};

}  // namespace patchlight
