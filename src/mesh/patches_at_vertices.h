#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The vertices of a patch's three or four corners.
std::span<const std::uint32_t> corner_vertices(const PatchMesh& mesh, PatchIndex patch);

/// The patches that have a corner at each vertex, in their order.
class PatchesAtVertices {
 public:
  explicit PatchesAtVertices(const PatchMesh& mesh);

  std::span<const PatchIndex> operator[](std::size_t vertex) const {
    return std::span(patches_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::size_t> first_;  // per vertex; one more at the end
  std::vector<PatchIndex> patches_;
};

}  // namespace patchlight
