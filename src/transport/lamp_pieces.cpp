#include "transport/lamp_pieces.h"

#include "base/sampling.h"
#include "scene/triangulate.h"
#include "visibility/occluder.h"

#include <algorithm>

namespace patchlight {
namespace {

PatchCorners turned(PatchCorners corners) {
  std::reverse(corners.points.begin(), corners.points.begin() + corners.count);
  if (corners.count == 3) corners.points[3] = corners.points[2];
  return corners;
}

bool is_convex_quadrilateral(const std::vector<Point>& points) {
  if (points.size() != 4) return false;
  const Vector normal = area_vector(points);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector edge = points[(k + 1) % 4] - points[k];
    if (!(edge.cross(points[(k + 2) % 4] - points[(k + 1) % 4]).dot(normal) > 0)) return false;
  }
  return true;
}

// Counter-clockwise from the side that shines.
std::vector<PatchCorners> pieces_of(const Scene& scene, const LampSide& lamp) {
  const std::vector<Point> points = corner_points(scene, lamp.polygon);
  std::vector<PatchCorners> pieces;
  if (is_convex_quadrilateral(points)) {
    pieces.push_back({{points[0], points[1], points[2], points[3]}, 4});
  } else {
    for (const auto& [a, b, c] : triangulate(points))
      pieces.push_back({{points[a], points[b], points[c], points[c]}, 3});
  }
  if (lamp.side == Side::back)
    for (PatchCorners& piece : pieces) piece = turned(piece);
  return pieces;
}

}  // namespace

std::size_t piece_count(const Scene& scene, const LampSide& lamp) { return pieces_of(scene, lamp).size(); }

std::vector<LampPiece> lamp_pieces(const Scene& scene, const PatchMesh& mesh, const Occluder& occluder,
                                   std::span<const LampSide> lamps, const std::vector<std::uint32_t>& keys) {
  std::vector<LampPiece> pieces;
  for (std::size_t lamp = 0; lamp < lamps.size(); ++lamp) {
    const auto& [polygon, side] = lamps[lamp];
    const PatchRange patches = mesh.patches_on(polygon, side);
    std::uint32_t key = patches.begin < patches.end ? keys[patches.begin] : 0;
    for (const PatchCorners& corners : pieces_of(scene, lamps[lamp])) {
      const PatchShape shape = patch_shape(corners);
      key = hash(key);
      pieces.push_back(
          {shape, sampled_patch(shape, polygon, occluder.frame()), occluder.held_share(polygon, side), key, lamp});
    }
  }
  return pieces;
}

}  // namespace patchlight
