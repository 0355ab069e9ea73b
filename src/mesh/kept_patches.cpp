#include "mesh/kept_patches.h"

#include <algorithm>
#include <cassert>
#include <vector>

namespace patchlight {

PatchMesh without_patches(const PatchMesh& mesh, std::span<const std::uint8_t> is_left_out) {
  assert(is_left_out.size() == mesh.size() && mesh.middles.empty());
  constexpr std::uint32_t none = ~std::uint32_t{0};
  PatchMesh kept;
  kept.sheets = mesh.sheets;
  std::vector<std::uint32_t> number(mesh.vertices.size(), none);
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const std::uint32_t vertex : mesh.corners[i]) number[vertex] = is_left_out[i] ? number[vertex] : 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<std::uint32_t>(kept.vertices.size());
    kept.vertices.push_back(mesh.vertices[v]);
  }
  std::size_t slot = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (; mesh.first_patch[slot] <= i; ++slot) kept.first_patch.push_back(kept.size());
    if (is_left_out[i]) continue;
    std::array<std::uint32_t, 4> corners = mesh.corners[i];
    for (std::uint32_t& corner : corners) corner = number[corner];
    kept.corners.push_back(corners);
    kept.centroid.push_back(mesh.centroid[i]);
    kept.normal.push_back(mesh.normal[i]);
    kept.area.push_back(mesh.area[i]);
    kept.material.push_back(mesh.material[i]);
    kept.polygon.push_back(mesh.polygon[i]);
    kept.side.push_back(mesh.side[i]);
  }
  for (; slot < mesh.first_patch.size(); ++slot) kept.first_patch.push_back(kept.size());
  return kept;
}

}  // namespace patchlight
