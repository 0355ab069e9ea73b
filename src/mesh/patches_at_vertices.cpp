#include "mesh/patches_at_vertices.h"

namespace patchlight {

std::span<const std::uint32_t> corner_vertices(const PatchMesh& mesh, PatchIndex patch) {
  return std::span(mesh.corners[patch]).first(static_cast<std::size_t>(mesh.corner_points(patch).count));
}

std::vector<std::vector<PatchIndex>> patches_at_vertices(const PatchMesh& mesh) {
  std::vector<std::vector<PatchIndex>> at(mesh.vertices.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) at[vertex].push_back(i);
  }
  return at;
}

}  // namespace patchlight
