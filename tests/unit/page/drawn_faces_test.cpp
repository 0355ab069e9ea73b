#include "page/drawn_faces.h"

#include "patchlight/simulate.h"

#include <gtest/gtest.h>
#include <map>

namespace patchlight::drawn_faces_test {
namespace {

// A closed box with a lamp on its ceiling.
Scene box() {
  Scene scene;
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  scene.polygons = {{{0, 1, 2, 3}, 0}, {{7, 6, 5, 4}, 1}, {{0, 4, 5, 1}, 0},
                    {{1, 5, 6, 2}, 0}, {{2, 6, 7, 3}, 0}, {{3, 7, 4, 0}, 0}};
  scene.materials = {{"wall", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}, {"lamp", rgb(0, 0, 0), rgb(1, 1, 1)}};
  return scene;
}

const Simulation& solved() {
  static const Simulation simulation = [] {
    Request request;
    request.mesh.patches = 600;
    return simulate(box(), request);
  }();
  return simulation;
}

double area_of(const DrawnFaces& drawn) {
  double area = 0;
  for (const auto& [a, b, c, d] : drawn.corners) {
    const std::vector<Point> points = {drawn.vertices[a], drawn.vertices[b], drawn.vertices[c], drawn.vertices[d]};
    area += area_vector(points).norm();
  }
  return area;
}

TEST(DrawnFaces, AreThePatchesWhereTheseAreFew) {
  const Scene scene = box();
  const SolvedSurface surface = surface_of(solved());
  const DrawnFaces drawn = drawn_faces(surface, 1, 1000);
  EXPECT_EQ(drawn.corners, solved().mesh.corners);
  EXPECT_EQ(drawn.vertices.size(), solved().mesh.vertices.size());
  EXPECT_EQ(drawn.patches.size(), solved().mesh.size());
  EXPECT_EQ(drawn.left_out, 0U);
}

// Whole faces cover the same area as their patches, with the same front sides.
TEST(DrawnFaces, CoverTheSameAreaWithFewerFaces) {
  const Scene scene = box();
  const SolvedSurface surface = surface_of(solved());
  const DrawnFaces drawn = drawn_faces(surface, 1, 300);
  EXPECT_LE(drawn.corners.size(), 300U);
  EXPECT_GT(drawn.corners.size(), 12U);
  EXPECT_EQ(drawn.left_out, 0U);
  EXPECT_NEAR(area_of(drawn), 6, 1e-12);
  PatchIndex patches = 0;
  for (const PatchRange& range : drawn.patches) patches += range.end - range.begin;
  EXPECT_EQ(patches, solved().mesh.size());
  for (std::size_t face = 0; face < drawn.corners.size(); ++face) {
    const auto& [a, b, c, d] = drawn.corners[face];
    const std::vector<Point> points = {drawn.vertices[a], drawn.vertices[b], drawn.vertices[c], drawn.vertices[d]};
    EXPECT_GT(area_vector(points).dot(solved().mesh.normal[drawn.patches[drawn.row[face]].begin]), 0);
  }
}

// The lamp has one radiance, so it loses nothing as one face and becomes whole first.
TEST(DrawnFaces, BecomeWholeWhereLeastIsLost) {
  const Scene scene = box();
  const SolvedSurface surface = surface_of(solved());
  const DrawnFaces drawn = drawn_faces(surface, 1, solved().mesh.size() - 1);
  std::map<PolygonIndex, PatchIndex> whole;
  for (const PatchRange& range : drawn.patches) {
    if (range.end - range.begin > 1) whole[solved().mesh.polygon[range.begin]] = range.end - range.begin;
  }
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(whole.begin()->first, 1U);
}

TEST(DrawnFaces, LeaveOutTheSmallestAtLast) {
  const Scene scene = box();
  const SolvedSurface surface = surface_of(solved());
  const DrawnFaces drawn = drawn_faces(surface, 1, 6);
  EXPECT_LE(drawn.corners.size(), 6U);
  EXPECT_EQ(drawn.patches.size(), 3U);
  EXPECT_NEAR(area_of(drawn), 3, 1e-12);
  PatchIndex patches = 0;
  for (const PatchRange& range : drawn.patches) patches += range.end - range.begin;
  EXPECT_EQ(patches + drawn.left_out, solved().mesh.size());
}

}  // namespace
}  // namespace patchlight::drawn_faces_test
