#include "mesh/patch_lookup.h"

#include "mesh/mesher.h"
#include "support/polygon_shapes.h"

#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace patchlight::patch_lookup_test {
namespace {

// A point of a patch, at least a twentieth of the patch's height away from every edge.
Point inner_point(const PatchCorners& patch, std::mt19937& random) {
  std::uniform_real_distribution<double> weight(0.1, 1);
  Point sum = Point::Zero();
  double total = 0;
  for (int k = 0; k < patch.count; ++k) {
    const double w = weight(random);
    sum += w * patch.points[static_cast<std::size_t>(k)];
    total += w;
  }
  return sum / total;
}

class LookupInEveryShape : public testing::TestWithParam<tiny::Shape> {};

TEST_P(LookupInEveryShape, FindsThePatchOfItsPoints) {
  const Scene& scene = GetParam().scene;
  for (const double max_edge : {10.0, 0.3, 0.02}) {
    const PatchMesh mesh = tessellate(scene, tiny::both_sides(scene), max_edge);
    const PatchLookup lookup(mesh);
    std::mt19937 random(1);
    for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
      EXPECT_EQ(lookup.patch_at(0, mesh.side[patch], mesh.centroid[patch]), patch);
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(lookup.patch_at(0, mesh.side[patch], inner_point(mesh.corner_points(patch), random)), patch);
      }
    }
  }
}

TEST_P(LookupInEveryShape, FindsManyAsOneAfterTheOther) {
  const Scene& scene = GetParam().scene;
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.1);
  const PatchLookup lookup(mesh);
  std::vector<SidePoint> points;
  for (const Point& point : mesh.centroid) points.push_back({0, Side::front, point});
  for (const Point& point : mesh.vertices) points.push_back({0, Side::front, point});
  points.push_back({0, Side::back, mesh.centroid[0]});
  const std::vector<PatchIndex> found = lookup.patches_at(points);
  ASSERT_EQ(found.size(), points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_EQ(found[k], lookup.patch_at(points[k].polygon, points[k].side, points[k].point).value_or(no_patch)) << k;
  }
  EXPECT_EQ(found.back(), no_patch);
}

TEST_P(LookupInEveryShape, FindsAPatchAtItsCornersAndJustOutside) {
  const Scene& scene = GetParam().scene;
  const double extent = bounds(scene).diagonal().norm();
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.3);
  const PatchLookup lookup(mesh);
  const auto closest_corner = [&](PatchIndex patch, const Point& point) {
    double distance = extent;
    const PatchCorners corners = mesh.corner_points(patch);
    for (const Point& corner : std::span<const Point>(corners)) distance = std::min(distance, (corner - point).norm());
    return distance;
  };
  for (const Point& corner : mesh.vertices) {
    for (const Vector& direction : {Vector(0, 0, 0), Vector(1, 0, 0), Vector(-1, 0, 0), Vector(0, 1, 0),
                                    Vector(0, -1, 0), Vector(0, 0, 1), Vector(0, 0, -1)}) {
      const auto patch = lookup.patch_at(0, Side::front, corner + 1e-6 * extent * direction);
      ASSERT_TRUE(patch);
      // One of the patches at the corner. The offset may exceed the thickness of thin patches.
      if (GetParam().thickness == 1) {
        EXPECT_EQ(closest_corner(*patch, corner), 0);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(PatchLookup, LookupInEveryShape, testing::ValuesIn(tiny::polygon_shapes()),
                         [](const auto& instance) { return instance.param.name; });

TEST(PatchLookup, FarOutsideFindsTheNearestPatch) {
  const Scene square = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const PatchMesh mesh = tessellate(square, tiny::front_sides(square), 0.1);
  const PatchLookup lookup(mesh);
  EXPECT_EQ(lookup.patch_at(0, Side::front, {-3, -3, 0}), lookup.patch_at(0, Side::front, {0.01, 0.01, 0}));
  EXPECT_EQ(lookup.patch_at(0, Side::front, {0.55, 7, 0}), lookup.patch_at(0, Side::front, {0.55, 0.99, 0}));
}

TEST(PatchLookup, WidensTheSearchInTheMouthOfAConcavePolygon) {
  // The mouth of the U is far from every patch. Its middle is slightly nearer to the left arm.
  const Scene scene = tiny::polygon(
      {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2.9, 3, 0}, {2.9, 0.1, 0}, {0.1, 0.1, 0}, {0.1, 3, 0}, {0, 3, 0}});
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.05);
  const PatchLookup lookup(mesh);
  const SidePoint in_the_mouth{0, Side::front, {1.3, 1.9, 0}};
  const auto patch = lookup.patch_at(0, Side::front, in_the_mouth.point);
  ASSERT_TRUE(patch);
  EXPECT_LT(mesh.centroid[*patch].x(), 0.1);
  EXPECT_EQ(lookup.patches_at({&in_the_mouth, 1}).front(), *patch);
}

// Map coordinates, where single precision resolves only 0.5 m. The shape is no parallelogram, so cells are searched.
TEST(PatchLookup, FindsPatchesFarFromTheOrigin) {
  const Point at(4e5, 5e6, 300);
  const Scene scene = tiny::polygon({at, at + Vector(1, 0, 0), at + Vector(1.2, 0.9, 0), at + Vector(0, 1, 0)});
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.05);
  ASSERT_GT(mesh.size(), 300U);
  const PatchLookup lookup(mesh);
  std::vector<SidePoint> points;
  for (const Point& centroid : mesh.centroid) points.push_back({0, Side::front, centroid});
  const std::vector<PatchIndex> found = lookup.patches_at(points);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) EXPECT_EQ(found[patch], patch);
}

TEST(PatchLookup, HasNothingOnASideThatIsNotKept) {
  const Scene square = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const PatchMesh mesh = tessellate(square, tiny::front_sides(square), 0.5);
  const PatchLookup lookup(mesh);
  EXPECT_FALSE(lookup.patch_at(0, Side::back, {0.5, 0.5, 0}));
  EXPECT_TRUE(lookup.patch_at(0, Side::front, {0.5, 0.5, 0}));
}

}  // namespace
}  // namespace patchlight::patch_lookup_test
