#include "mesh/mesher.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <vector>

namespace patchlight::graded_edges_test {
namespace {

using namespace test;

KeptSides kept(const Scene& scene, bool front, bool back) {
  const std::size_t count = scene.polygons.size();
  return {std::vector<std::uint8_t>(count, front ? 1 : 0), std::vector<std::uint8_t>(count, back ? 1 : 0), {}, {}};
}

PatchMesh graded_mesh(const Scene& scene, double max_edge, bool front = true, bool back = false) {
  return tessellate(scene, kept(scene, front, back), max_edge, {}, true);
}

// The coordinates of the vertices of one polygon's patches along an axis, each once.
std::vector<double> places_on(const PatchMesh& mesh, PolygonIndex polygon, int axis) {
  std::vector<double> places;
  const PatchRange range = mesh.patches_on(polygon, Side::front);
  for (PatchIndex i = range.begin; i < range.end; ++i) {
    for (const std::uint32_t vertex : mesh.corners[i]) places.push_back(mesh.vertices[vertex][axis]);
  }
  std::sort(places.begin(), places.end());
  const auto same = [](double a, double b) { return b - a < 1e-12; };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
  return places;
}

std::vector<double> cosines_of(int parts) {
  std::vector<double> places;
  for (int k = 0; k <= parts; ++k) places.push_back((1 - std::cos(std::numbers::pi * k / parts)) / 2);
  return places;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-12) << k;
}

// A floor and a wall that rises from its edge at y = 0.
Scene floor_and_wall(const Point& top_of_wall) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  return with_quad(std::move(scene),
                   {Point(1, 0, 0), Point(0, 0, 0), top_of_wall, Point(top_of_wall + Vector(1, 0, 0))});
}

TEST(GradedEdges, ShrinkPatchesTowardsEveryEdgeOfARoom) {
  const Scene room = cube_room(0.5, 0.5);
  const PatchMesh mesh = graded_mesh(room, 0.125);
  EXPECT_EQ(mesh.size(), tessellate(room, kept(room, true, false), 0.125).size());
  for (PolygonIndex p = 0; p < room.polygons.size(); ++p) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double> places = places_on(mesh, p, axis);
      if (places.size() > 1) expect_near(places, cosines_of(8));
    }
  }
  EXPECT_NEAR(std::accumulate(mesh.area.begin(), mesh.area.end(), 0.0), 6, 1e-12);
}

TEST(GradedEdges, ShrinkPatchesTowardsTheOneEdgeThatMeetsAWall) {
  const PatchMesh mesh = graded_mesh(floor_and_wall(Point(0, 0, 1)), 0.25);
  std::vector<double> shrinking;
  for (int k = 0; k <= 4; ++k) shrinking.push_back(1 - std::cos(std::numbers::pi / 2 * k / 4));
  expect_near(places_on(mesh, 0, 1), shrinking);
  expect_near(places_on(mesh, 0, 0), {0, 0.25, 0.5, 0.75, 1});
}

// A nearly flat fold, a wall that goes down and a wall whose lit side faces away.
TEST(GradedEdges, LeaveOtherEdgesEven) {
  for (const Point& top : {Point(0, -1, 0.5), Point(0, 0, -1), Point(0, -1, 0)})
    expect_near(places_on(graded_mesh(floor_and_wall(top), 0.25), 0, 1), {0, 0.25, 0.5, 0.75, 1});
  Scene averted = floor_and_wall(Point(0, 0, 1));
  std::reverse(averted.polygons[1].corners.begin(), averted.polygons[1].corners.end());
  expect_near(places_on(graded_mesh(averted, 0.25), 0, 1), {0, 0.25, 0.5, 0.75, 1});
}

// The backs of a box see each other like the fronts of a room.
TEST(GradedEdges, AreThoseThatKeptSidesSee) {
  const Scene solid = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(1, 1, 1), false);
  const PatchMesh outside = graded_mesh(solid, 0.25);
  const PatchMesh even = tessellate(solid, kept(solid, true, false), 0.25);
  EXPECT_EQ(outside.vertices, even.vertices);
  EXPECT_NE(graded_mesh(solid, 0.25, false, true).vertices, tessellate(solid, kept(solid, false, true), 0.25).vertices);
}

// Two halves of a floor. Only one of them meets a wall, in its far corner. Both are even along their seam, and share
// their points.
TEST(GradedEdges, AgreeAlongSeams) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(1, 0, 0), Point(2, 0, 0), Point(2, 1, 0), Point(1, 1, 0)});
  Scene one_wall = with_quad(scene, {Point(1, 0, 0), Point(0, 0, 0), Point(0, 0, 1), Point(1, 0, 1)});
  const PatchMesh mesh = graded_mesh(one_wall, 0.25);
  expect_near(places_on(mesh, 0, 1), {0, 0.25, 0.5, 0.75, 1});
  expect_near(places_on(mesh, 1, 1), {0, 0.25, 0.5, 0.75, 1});
  const Scene two_walls =
      with_quad(std::move(one_wall), {Point(2, 0, 0), Point(1, 0, 0), Point(1, 0, 1), Point(2, 0, 1)});
  const PatchMesh graded = graded_mesh(two_walls, 0.25);
  EXPECT_LT(places_on(graded, 0, 1)[1], 0.1);
  expect_near(places_on(graded, 1, 1), places_on(graded, 0, 1));
  // 5 x 9 vertices on the floor and on the wall, because each seam has its vertices once.
  EXPECT_EQ(graded.vertices.size(), 2 * 45u);
}

}  // namespace
}  // namespace patchlight::graded_edges_test
