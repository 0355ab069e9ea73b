#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"

#include <vector>

namespace patchlight {

/// A mesh of which no edge is longer.
struct SizedMesh {
  double max_edge = 0;  ///< metres
  PatchMesh mesh;
};

/// Meshes each of which is cut from the one before, so that means over the patches of all can be taken from the last
/// without an error of their own: where a reference's patches reach over the edge of another patch, it would be off by
/// as much as they are large. Longest edges are halved each time, so that there are about four times the patches; what
/// would have more than half the patches of the next one is left out.
struct NestedSizes {
  std::vector<SizedMesh> sizes;  ///< from coarse to fine; the last one is about what the request asks for
  SizedMesh finer;               ///< with half the edges
  double coarsest_edge = 0;      ///< with which the scene is tessellated; metres
};

/// `sizes` sizes at most. \throws MemoryError when the finer mesh would not fit.
NestedSizes nested_sizes(const Scene& scene, const Request& request, int sizes);

/// The mesh, cut until a patch has no more than a quarter of the area of the one of `other` at its centre. Both are cut
/// from one tessellation: so each patch lies in one of `other`.
PatchMesh finer_than(PatchMesh mesh, const PatchMesh& other);

}  // namespace patchlight
