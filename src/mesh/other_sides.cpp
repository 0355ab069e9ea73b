#include "mesh/other_sides.h"

#include "mesh/outline.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace patchlight {
namespace {

// The same for both sides, which have their own vertices at the same places.
using SideCorners = std::array<Point, 4>;

SideCorners sorted_corners(PatchCorners corners) {
  // A triangle repeats its last corner.
  std::sort(corners.points.begin(), corners.points.begin() + corners.count, comes_before);
  if (corners.count == 3) corners.points[3] = corners.points[2];
  return corners.points;
}

struct CornersComeBefore {
  bool operator()(const SideCorners& a, const SideCorners& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), comes_before);
  }
};

}  // namespace

std::vector<PatchIndex> other_sides(const PatchMesh& mesh) {
  if (mesh.sheets.empty()) return {};
  std::vector<PatchIndex> other_side(mesh.size());
  std::iota(other_side.begin(), other_side.end(), PatchIndex{0});
  for (const PolygonIndex sheet : mesh.sheets) {
    std::map<SideCorners, PatchIndex, CornersComeBefore> fronts;
    const PatchRange front = mesh.patches_on(sheet, Side::front);
    for (PatchIndex i = front.begin; i < front.end; ++i) fronts.emplace(sorted_corners(mesh.corner_points(i)), i);
    const PatchRange back = mesh.patches_on(sheet, Side::back);
    for (PatchIndex j = back.begin; j < back.end; ++j) {
      const auto found = fronts.find(sorted_corners(mesh.corner_points(j)));
      if (found == fronts.end()) continue;
      other_side[j] = found->second;
      other_side[found->second] = j;
    }
  }
  return other_side;
}

}  // namespace patchlight
