#include "base/sampling.h"
#include "transport/smoothing.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace patchlight::patch_cells_test {
namespace {

// Random patches in a box of these sides, with its corner below 0.
PatchMesh strewn(PatchIndex count, const Vector& sides) {
  PatchMesh mesh;
  const auto drawn = [](PatchIndex i, std::uint32_t axis) { return hash({i, axis}) * 0x1p-32; };
  for (PatchIndex i = 0; i < count; ++i) {
    const Vector share(drawn(i, 0), drawn(i, 1), drawn(i, 2));
    mesh.centroid.emplace_back(share.cwiseProduct(sides) - Vector(3, 2, 1));
    mesh.area.push_back(1);
  }
  return mesh;
}

// The cells of a patch and around it contain all patches within an edge of it, each once, at every level.
TEST(PatchCells, NameAllThatAreNear) {
  const PatchMesh mesh = strewn(500, {4, 3, 0.5});
  constexpr double length = 0.3;
  const PatchCells cells(mesh, length);
  for (const int halvings : {-1, 0, 1, 2}) {
    const double radius = std::ldexp(length, -halvings);
    const int level = cells.level_of(radius);
    for (std::size_t place = 0; place < cells.size(); ++place) {
      const std::vector<PatchIndex> near = cells.around(cells.cell(place, level)).patches;
      const std::set<PatchIndex> each(near.begin(), near.end());
      EXPECT_EQ(each.size(), near.size());
      const Point& centroid = mesh.centroid[cells.patch(place)];
      for (PatchIndex j = 0; j < 500; ++j)
        EXPECT_TRUE((mesh.centroid[j] - centroid).norm() > radius || each.contains(j)) << j << " at " << radius;
    }
  }
}

// Patches of one cell are consecutive, and lie within an edge along each axis.
TEST(PatchCells, PutPatchesOfACellTogether) {
  const PatchMesh mesh = strewn(500, {4, 3, 0.5});
  const PatchCells cells(mesh, 0.3);
  const int level = cells.level_of(0.3);
  std::set<std::uint64_t> seen;
  for (std::size_t place = 0; place < cells.size(); ++place) {
    const Cell cell = cells.cell(place, level);
    if (place > 0 && cells.cell(place - 1, level) == cell) {
      const Vector way = mesh.centroid[cells.patch(place)] - mesh.centroid[cells.patch(place - 1)];
      EXPECT_LE(way.cwiseAbs().maxCoeff(), 1.001 * 0.3);
    } else {
      EXPECT_TRUE(seen.insert(cell.code).second);
    }
  }
}

// Patches at one point are near each other by any measure. Without patches there are no cells.
TEST(PatchCells, TakePatchesAtOnePoint) {
  PatchMesh mesh = strewn(3, {0, 0, 0});
  const PatchCells cells(mesh, 1e9);
  EXPECT_EQ(cells.around(cells.cell(1, cells.level_of(1e9))).patches.size(), 3U);
  EXPECT_EQ(cells.around(cells.cell(1, cells.level_of(1e-9))).patches.size(), 3U);
  EXPECT_EQ(PatchCells(PatchMesh(), 1).size(), 0U);
}

}  // namespace
}  // namespace patchlight::patch_cells_test
