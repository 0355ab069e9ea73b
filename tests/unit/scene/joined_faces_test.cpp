#include "mesh/mesher.h"
#include "scene/less_detail.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::joined_faces_test {
namespace {

using namespace test;

// A square of `size` meters in n x n squares of two triangles each: all of them, or those selected by `has`.
template <typename Has>
Scene triangulated(int n, double size, Has has) {
  Scene scene = empty_scene({grey(0.5), grey(0.2)});
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) scene.vertices.emplace_back(size * x / n, size * y / n, 0);
  }
  const auto vertex = [n](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      if (!has(x, y)) continue;
      scene.polygons.push_back({.corners = {vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1)}});
      scene.polygons.push_back({.corners = {vertex(x, y), vertex(x + 1, y + 1), vertex(x, y + 1)}});
    }
  }
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) scene.polygons[p].face = p;
  return scene;
}

bool everywhere(int, int) { return true; }

double area(const Scene& scene) {
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) sum += area_vector(corner_points(scene, p)).norm();
  return sum;
}

TEST(JoinedFaces, ASquareInTrianglesIsASquare) {
  const Scene joined = with_joined_faces(triangulated(5, 2, everywhere));
  ASSERT_EQ(joined.polygons.size(), 1u);
  EXPECT_EQ(joined.polygons[0].corners.size(), 4u);
  EXPECT_EQ(joined.polygons[0].face, 0u);
  EXPECT_NEAR(area(joined), 4, 1e-12);
  EXPECT_NEAR(front_normal(joined, 0).z(), 1, 1e-12);
}

TEST(JoinedFaces, AHoleAndAnIslandInItStay) {
  const auto has = [](int x, int y) {
    const int ring = std::min(std::min(x, 6 - x), std::min(y, 6 - y));
    return ring == 0 || ring >= 2;
  };
  const Scene joined = with_joined_faces(triangulated(7, 7, has));
  ASSERT_EQ(joined.polygons.size(), 2u);
  EXPECT_NEAR(area(joined), 24 + 9, 1e-12);
  check(joined);
  const PatchMesh mesh = tessellate(joined, kept_sides(joined, Sides::front), 0.5);
  double sum = 0;
  for (const double patch : mesh.area) {
    EXPECT_GT(patch, 0);
    sum += patch;
  }
  EXPECT_NEAR(sum, 33, 1e-9);
}

TEST(JoinedFaces, TwoHolesAndAPinchedCornerKeepTheArea) {
  const auto has = [](int x, int y) { return !(x == 1 && y == 1) && !(x == 2 && y == 2) && !(x == 4 && y == 3); };
  const Scene joined = with_joined_faces(triangulated(6, 6, has));
  EXPECT_NEAR(area(joined), 33, 1e-12);
  check(joined);
}

TEST(JoinedFaces, OfAnotherMaterialObjectPlaneOrDirectionStayApart) {
  Scene scene = triangulated(1, 1, everywhere);
  EXPECT_EQ(with_joined_faces(scene).polygons.size(), 1u);
  Scene other = scene;
  other.polygons[1].material = 1;
  EXPECT_EQ(with_joined_faces(other).polygons.size(), 2u);
  other = scene;
  other.polygons[1].back_material = 1;
  EXPECT_EQ(with_joined_faces(other).polygons.size(), 2u);
  other = scene;
  other.groups = {"a", "b"};
  other.polygons[1].group = 1;
  EXPECT_EQ(with_joined_faces(other).polygons.size(), 2u);
  other = scene;
  other.vertices[2].z() = 5e-4;  // the corner of the second alone
  EXPECT_EQ(with_joined_faces(other).polygons.size(), 2u);
  other = scene;
  std::reverse(other.polygons[1].corners.begin(), other.polygons[1].corners.end());
  EXPECT_EQ(with_joined_faces(other).polygons.size(), 2u);
}

TEST(JoinedFaces, AnEdgeWithAThirdFaceStays) {
  Scene scene = triangulated(1, 1, everywhere);
  scene.vertices.emplace_back(0.5, 0.5, 1);
  scene.polygons.push_back({.corners = {0, 3, 4}, .face = 2});  // over the diagonal
  EXPECT_EQ(with_joined_faces(scene).polygons.size(), 3u);
}

TEST(JoinedFaces, CornersThatOthersNeedStay) {
  Scene scene = triangulated(2, 2, everywhere);
  scene.vertices.emplace_back(1, 0, 1);
  scene.vertices.emplace_back(0, 0, 1);
  scene.polygons.push_back({.corners = {0, 10, 9, 1}, .face = 8});  // a wall over half of the edge y = 0
  const Scene joined = with_joined_faces(scene);
  ASSERT_EQ(joined.polygons.size(), 2u);
  EXPECT_EQ(joined.polygons[0].corners.size(), 5u);
}

TEST(JoinedFaces, AMeshOfQuadrilateralsStays) {
  Scene scene = empty_scene({grey(0.5)});
  for (int x = 0; x < 3; ++x) {
    scene.vertices.emplace_back(x, 0, 0);
    scene.vertices.emplace_back(x, 1, 0);
  }
  scene.polygons.push_back({.corners = {0, 2, 3, 1}});
  scene.polygons.push_back({.corners = {2, 4, 5, 3}});
  EXPECT_EQ(with_joined_faces(scene).polygons.size(), 2u);
}

TEST(JoinedFaces, TheRimOfADiscStaysRound) {
  constexpr int sides = 1000;
  Scene scene = empty_scene({grey(0.5)});
  scene.vertices.emplace_back(0, 0, 0);
  for (std::uint32_t k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    scene.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    scene.polygons.push_back({.corners = {0, 1 + k, 1 + (k + 1) % sides}, .face = k});
  }
  const double before = area(scene);
  const Scene joined = with_joined_faces(scene);
  ASSERT_EQ(joined.polygons.size(), 1u);
  EXPECT_EQ(joined.polygons[0].corners.size(), std::size_t{sides});
  EXPECT_NEAR(area(joined), before, 1e-12);
}

}  // namespace
}  // namespace patchlight::joined_faces_test
