#include "patchlight/simulate.h"

#include "mesh/patch_lookup.h"
#include "study/study.h"
#include "support/daylight_office.h"

#include <gtest/gtest.h>

namespace patchlight::nested_sizes_test {
namespace {

using namespace test;

TEST(FinerThan, HasFourPatchesOrMoreInEachOfBothMeshes) {
  // A furnished room that is refined where needed, and a uniform mesh. Means over the patches of both are exact. In
  // meters, and rotated in millimeters.
  for (const double unit : {1.0, 1e-3}) {
    const Scene scene = turned(furnished_room(0.7), unit);
    Request request;
    request.mesh.patches = 150;
    request.mesh.sides = Sides::front;
    const NestedSizes sizes = nested_sizes(scene, request, 3);
    Request asked = request;
    asked.mesh.patches.reset();
    asked.mesh.max_edge = sizes.coarsest_edge / 2;
    asked.accuracy.relative_error = 0.01;
    const PatchMesh adaptive = simulate(scene, asked).mesh;
    const PatchMesh finer = finer_than(sizes.finer.mesh, adaptive);
    EXPECT_GT(finer.size(), sizes.finer.mesh.size());
    for (const PatchMesh* mesh : {&adaptive, &sizes.sizes.back().mesh}) {
      const PatchLookup lookup(*mesh);
      for (PatchIndex i = 0; i < finer.size(); ++i) {
        const PatchCorners corners = finer.corner_points(i);
        const auto middle = lookup.patch_at(finer.polygon[i], finer.side[i], finer.centroid[i]);
        ASSERT_TRUE(middle);
        EXPECT_LT(finer.area[i], 0.2501 * mesh->area[*middle]);
        for (int k = 0; k < corners.count; ++k) {
          const Point near_corner = 0.999 * corners.points[static_cast<std::size_t>(k)] + 0.001 * finer.centroid[i];
          EXPECT_EQ(lookup.patch_at(finer.polygon[i], finer.side[i], near_corner), middle);
        }
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::nested_sizes_test
