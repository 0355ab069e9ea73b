#include "scene/shells.h"

#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::shells_test {
namespace {

using namespace test;

Scene cube() { return cube_room(0.5, 0); }

Scene with_turned(Scene scene, PolygonIndex polygon) {
  auto& corners = scene.polygons[polygon].corners;
  std::reverse(corners.begin(), corners.end());
  return scene;
}

TEST(ShellsOf, ACubeIsOneClosedShell) {
  const Shells shells = shells_of(cube());
  EXPECT_EQ(shells.count, 1U);
  EXPECT_EQ(shells.closed_count, 1U);
  EXPECT_TRUE(shells.rim.empty());
  EXPECT_EQ(shells.branched_edges, 0U);
  EXPECT_EQ(std::count(shells.turned.begin(), shells.turned.end(), 1), 0);
}

TEST(ShellsOf, AnyOneTurnedFaceIsFoundAndTheShellStaysClosed) {
  for (PolygonIndex p = 0; p < 6; ++p) {
    const Shells shells = shells_of(with_turned(cube(), p));
    for (PolygonIndex other = 0; other < 6; ++other) EXPECT_EQ(shells.turned[other], other == p);
    EXPECT_EQ(shells.closed_count, 1U);
  }
  // The larger area decides: with all faces inverted, the result is the same as with none.
  Scene all = cube();
  for (PolygonIndex p = 0; p < 6; ++p) all = with_turned(std::move(all), p);
  const Shells shells = shells_of(all);
  EXPECT_EQ(std::count(shells.turned.begin(), shells.turned.end(), 1), 0);
}

TEST(ShellsOf, AMissingFaceLeavesItsRim) {
  Scene scene = cube();
  scene.polygons.pop_back();
  const Shells shells = shells_of(scene);
  EXPECT_EQ(shells.closed_count, 0U);
  double length = 0;
  for (const RimEdge& edge : shells.rim) length += (scene.vertices[edge.to] - scene.vertices[edge.from]).norm();
  EXPECT_EQ(shells.rim.size(), 4U);
  EXPECT_DOUBLE_EQ(length, 4);
}

TEST(ShellsOf, CubesThatShareAnEdgeAreOneBranchedShell) {
  const Scene scene = with_box(cube(), Point(1, 1, 0), Point(2, 2, 1), true);
  const Shells shells = shells_of(scene);
  EXPECT_EQ(shells.count, 1U);
  EXPECT_EQ(shells.closed_count, 0U);
  EXPECT_EQ(shells.branched_edges, 1U);
  EXPECT_EQ(shells.branched.size(), 4U);
  EXPECT_EQ(shells_of(with_box(cube(), Point(1, 1, 1), Point(2, 2, 2), true)).count, 2U) << "a corner joins nothing";
}

// A Moebius band of quadrilaterals cannot be oriented, and has one rim.
TEST(ShellsOf, AMoebiusBandIsOneOpenShell) {
  constexpr int parts = 12;
  const auto rung = [](int k) {
    const double angle = 2 * M_PI * k / parts;
    const Vector out(std::cos(angle), std::sin(angle), 0);
    const Vector across = 0.3 * (std::cos(angle / 2) * Vector::UnitZ() + std::sin(angle / 2) * out);
    return std::array<Point, 2>{out - across, out + across};
  };
  Scene scene = empty_scene({grey(0.5)});
  for (int k = 0; k < parts; ++k) {
    const auto [a, b] = rung(k);
    const auto [c, d] = rung(k + 1);
    scene = with_polygon(std::move(scene), {a, c, b});
    scene = with_polygon(std::move(scene), {c, d, b});
  }
  const Shells shells = shells_of(scene);
  EXPECT_EQ(shells.count, 1U);
  EXPECT_EQ(shells.closed_count, 0U);
  EXPECT_EQ(shells.rim.size(), 2U * parts);
}

}  // namespace
}  // namespace patchlight::shells_test
