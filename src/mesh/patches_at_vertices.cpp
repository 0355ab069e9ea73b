#include "mesh/patches_at_vertices.h"

#include <numeric>

namespace patchlight {

std::span<const std::uint32_t> corner_vertices(const PatchMesh& mesh, PatchIndex patch) {
  const auto& corners = mesh.corners[patch];
  return std::span(corners).first(corners[3] == corners[2] ? 3 : 4);
}

// Sorted by counting.
PatchesAtVertices::PatchesAtVertices(const PatchMesh& mesh) : first_(mesh.vertices.size() + 1, 0) {
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) ++first_[vertex + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  patches_.resize(first_.back());
  std::vector<std::size_t> next = first_;
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) patches_[next[vertex]++] = i;
}

}  // namespace patchlight
