#include "mesh/mesher.h"
#include "support/polygon_shapes.h"

#include <gtest/gtest.h>

namespace patchlight::max_edge_for_test {
namespace {

PatchIndex patches_for(const Scene& scene, PatchIndex wanted) {
  const KeptSides sides = tiny::front_sides(scene);
  return tessellate(scene, sides, max_edge_for(scene, sides, wanted)).size();
}

TEST(MaxEdgeFor, IsWithinTenPercent) {
  for (const PatchIndex wanted : {300u, 1000u, 5000u}) {
    for (const tiny::Shape& shape : tiny::polygon_shapes()) {
      // A grid has n^2 or n m patches: near 300 the steps are still below 12 %.
      EXPECT_NEAR(patches_for(shape.scene, wanted), wanted, 0.1 * wanted) << shape.name;
    }
    for (const Scene& scene : {tiny::box({4, 3, 2.5}), tiny::in_triangles(tiny::box({4, 3, 2.5}))}) {
      EXPECT_NEAR(patches_for(scene, wanted), wanted, 0.1 * wanted);
    }
  }
}

TEST(MaxEdgeFor, FindsTheNearestStep) {
  const Scene square = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  EXPECT_EQ(patches_for(square, 1), 1u);
  EXPECT_EQ(patches_for(square, 100), 100u);
  EXPECT_EQ(patches_for(square, 1000), 1024u);  // 31^2 = 961 is farther
  EXPECT_EQ(patches_for(square, 990), 961u);
  const Scene cube = tiny::box({1, 1, 1});
  EXPECT_EQ(patches_for(cube, 1), 6u);  // never fewer than the polygons
  EXPECT_EQ(patches_for(cube, 14), 6u);
  EXPECT_EQ(patches_for(cube, 16), 24u);
}

TEST(MaxEdgeFor, CountsBothSides) {
  const Scene square = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const KeptSides sides = tiny::both_sides(square);
  EXPECT_EQ(tessellate(square, sides, max_edge_for(square, sides, 200)).size(), 200u);
}

}  // namespace
}  // namespace patchlight::max_edge_for_test
