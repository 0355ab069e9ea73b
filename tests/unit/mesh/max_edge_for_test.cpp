#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "support/polygon_shapes.h"

#include <gtest/gtest.h>
#include <vector>

namespace patchlight::max_edge_for_test {
namespace {

PatchIndex patches_for(const Scene& scene, PatchIndex wanted) {
  const KeptSides sides = tiny::front_sides(scene);
  return tessellate(scene, sides, max_edge_for(scene, sides, wanted)).size();
}

TEST(MaxEdgeFor, IsWithinTenPercent) {
  for (const PatchIndex wanted : {300u, 1000u, 5000u}) {
    for (const tiny::Shape& shape : tiny::polygon_shapes()) {
      // A grid has n^2 or n m patches, so near 300 the steps are still below 12 %.
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

std::vector<Scene> rooms_and_shapes() {
  std::vector<Scene> scenes{tiny::box({4, 3, 2.5}), tiny::in_triangles(tiny::box({4, 3, 2.5}))};
  for (const tiny::Shape& shape : tiny::polygon_shapes()) scenes.push_back(shape.scene);
  return scenes;
}

// Counted without a mesh, and with stored counts for other edges.
TEST(EdgeSearch, NestedPatchesAreThoseOfTheNestedMesh) {
  for (const Scene& scene : rooms_and_shapes()) {
    const KeptSides sides = tiny::both_sides(scene);
    const ContactLines no_contacts;
    EdgeSearch search(scene, sides, no_contacts);
    for (const double edge : {20.0, 0.7, 3.0, 0.31, 8.0, 0.1}) {
      const PatchMesh mesh = nest(tessellate(scene, sides, edge)).patches;
      EXPECT_EQ(search.nested_patches_with(edge), mesh.size()) << scene.file << " " << edge;
    }
  }
}

// The result does not depend on earlier searches.
TEST(EdgeSearch, RemembersNothingThatIsOfOtherEdges) {
  for (const Scene& scene : rooms_and_shapes()) {
    const KeptSides sides = tiny::front_sides(scene);
    const ContactLines no_contacts;
    EdgeSearch search(scene, sides, no_contacts);
    for (const double edge : {0.2, 9.0, 0.6, 2.0, 0.2001}) {
      EXPECT_EQ(search.patches_with(edge), tessellate(scene, sides, edge).size()) << scene.file << " " << edge;
    }
  }
}

TEST(EdgeSearch, FindsAsManyNestedPatchesAsAreWanted) {
  for (const Scene& scene : rooms_and_shapes()) {
    const KeptSides sides = tiny::front_sides(scene);
    const ContactLines no_contacts;
    EdgeSearch search(scene, sides, no_contacts);
    const PatchMesh mesh = nest(tessellate(scene, sides, search.nested_edge_for(3000))).patches;
    // One triangle is a grid of n^2, each in four. From 27^2 to 28^2 the step is 7 %, so the nearer end is within 4 %.
    EXPECT_NEAR(mesh.size(), 3000, 0.05 * 3000) << scene.file;
  }
}

}  // namespace
}  // namespace patchlight::max_edge_for_test
