#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

PatchCorners PatchMesh::corner_points(PatchIndex patch) const {
  const auto& indices = corners[patch];
  PatchCorners result;
  for (std::size_t k = 0; k < 4; ++k) result.points[k] = vertices[indices[k]];
  result.count = indices[3] == indices[2] ? 3 : 4;
  return result;
}

PatchRange PatchMesh::patches_on(PolygonIndex on_polygon, Side on_side) const {
  const std::size_t slot = 2 * static_cast<std::size_t>(on_polygon) + static_cast<std::size_t>(on_side);
  return {first_patch[slot], first_patch[slot + 1]};
}

}  // namespace patchlight
