#include "mesh/mesher.h"
#include "support/tiny_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <set>
#include <tuple>
#include <vector>

namespace patchlight::shared_vertices_test {
namespace {

using Coordinates = std::tuple<double, double, double>;

Coordinates coordinates(const Point& point) { return {point.x(), point.y(), point.z()}; }

std::set<std::uint32_t> vertices_of(const PatchMesh& mesh, PolygonIndex polygon, Side side = Side::front) {
  std::set<std::uint32_t> vertices;
  const PatchRange range = mesh.patches_on(polygon, side);
  for (PatchIndex patch = range.begin; patch < range.end; ++patch) {
    vertices.insert(mesh.corners[patch].begin(), mesh.corners[patch].end());
  }
  return vertices;
}

std::size_t shared_vertices(const PatchMesh& mesh, PolygonIndex a, PolygonIndex b, Side side = Side::front) {
  std::size_t count = 0;
  const std::set<std::uint32_t> other = vertices_of(mesh, b, side);
  for (const std::uint32_t vertex : vertices_of(mesh, a, side)) count += other.count(vertex);
  return count;
}

// Two unit squares that share an edge. The second is bent up by `degrees`.
Scene hinge(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const double x = 1 + std::cos(angle), z = std::sin(angle);
  return tiny::scene_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {x, 0, z}, {x, 1, z}},
                        {{0, 1, 2, 3}, {1, 4, 5, 2}});
}

std::size_t shared_at_hinge(const Scene& scene, Side side = Side::front) {
  return shared_vertices(tessellate(scene, tiny::both_sides(scene), 0.1), 0, 1, side);
}

TEST(SharedVertices, NeighboursHaveTheSamePointsOnTheirEdge) {
  // A square, a scalene triangle and a pentagon around one edge, each with its own vertices and another winding.
  const Point a(0.1, 0.2, 0.3), b(1.3, -0.4, 0.9);
  const Vector up(0.3, 1, 0.2), out(0.5, 0.1, 1);
  const Scene scene = tiny::scene_of({a, b, b + up, a + up, b, a, a + 0.37 * out + 0.1 * (b - a), a, b, b - 0.5 * out,
                                      a - 1.3 * out + 0.4 * (b - a), a - 0.8 * out},
                                     {{0, 1, 2, 3}, {4, 5, 6}, {7, 8, 9, 10, 11}});
  for (const double max_edge : {3.0, 0.5, 0.21, 0.05}) {
    const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), max_edge);
    const auto on_edge = [&](PolygonIndex polygon) {
      std::set<Coordinates> points;
      for (const std::uint32_t vertex : vertices_of(mesh, polygon)) {
        const Vector offset = mesh.vertices[vertex] - a;
        if (offset.cross((b - a).normalized()).norm() < 1e-9) points.insert(coordinates(mesh.vertices[vertex]));
      }
      return points;
    };
    EXPECT_EQ(on_edge(0).size(), static_cast<std::size_t>(std::ceil((b - a).norm() / max_edge)) + 1);
    EXPECT_EQ(on_edge(0), on_edge(1));
    EXPECT_EQ(on_edge(0), on_edge(2));
  }
}

TEST(SharedVertices, FlatAndNearlyFlatNeighboursShareTheirEdge) {
  EXPECT_EQ(shared_at_hinge(hinge(0)), 11u);
  EXPECT_EQ(shared_at_hinge(hinge(29)), 11u);
  EXPECT_EQ(shared_at_hinge(hinge(-29)), 11u);
  EXPECT_EQ(shared_at_hinge(hinge(29), Side::back), 11u);
  // The two halves of the first square have a diagonal of ceil(1.414 / 0.1) parts.
  EXPECT_EQ(shared_at_hinge(tiny::in_triangles(hinge(0))), 16u);
}

TEST(SharedVertices, CreasesMaterialsAndWindingsSeparate) {
  EXPECT_EQ(shared_at_hinge(hinge(31)), 0u);
  EXPECT_EQ(shared_at_hinge(hinge(90)), 0u);

  Scene painted = hinge(0);
  painted.materials.resize(2);
  painted.polygons[1].material = 1;
  EXPECT_EQ(shared_at_hinge(painted), 0u);

  Scene turned = hinge(0);
  turned.polygons[1].corners = {2, 5, 4, 1};
  EXPECT_EQ(shared_at_hinge(turned), 0u);
}

TEST(SharedVertices, AnEdgeOfThreePolygonsSeparates) {
  Scene scene = hinge(0);
  scene.vertices.insert(scene.vertices.end(), {{2, 0, 0.1}, {2, 1, 0.1}});
  scene.polygons.push_back(scene.polygons[1]);
  scene.polygons[2].corners = {1, 6, 7, 2};
  EXPECT_EQ(shared_at_hinge(scene), 0u);
}

// A ceiling of its own paint that ends at the walls of two storeys, for any kept sides.
TEST(SharedVertices, AWallOnTheEdgeSeparatesTheSideOnWhichItStands) {
  for (const double degrees : {0.0, 25.0, -25.0}) {
    Scene scene = hinge(degrees);
    scene.vertices.insert(scene.vertices.end(), {{1, 0, 1}, {1, 1, 1}});
    scene.materials.resize(2);
    scene.polygons.push_back(scene.polygons[1]);
    scene.polygons[2].material = 1;
    for (const tiny::Corners& corners : {tiny::Corners{1, 6, 7, 2}, tiny::Corners{2, 7, 6, 1}}) {
      scene.polygons[2].corners = corners;
      for (const bool is_kept : {true, false}) {
        KeptSides sides = tiny::both_sides(scene);
        sides.front[2] = sides.back[2] = is_kept ? 1 : 0;
        const PatchMesh mesh = tessellate(scene, sides, 0.1);
        EXPECT_EQ(shared_vertices(mesh, 0, 1, Side::front), 0U) << degrees;
        EXPECT_EQ(shared_vertices(mesh, 0, 1, Side::back), 11U) << degrees;
      }
    }
  }
}

// The walls of two stories are cut beside a window, and the ceiling at them is not; or walls are longer than rooms.
TEST(SharedVertices, AWallOnPartOfTheEdgeSeparatesIfItIsAtTheMiddle) {
  const auto shared_with_wall = [](double begin, double end, double height) {
    Scene scene = hinge(0);
    scene.vertices.insert(scene.vertices.end(),
                          {{1, begin, height}, {1, end, height}, {1, end, 1 + height}, {1, begin, 1 + height}});
    scene.materials.resize(2);
    scene.polygons.push_back(scene.polygons[1]);
    scene.polygons[2].material = 1;
    scene.polygons[2].corners = {6, 7, 8, 9};
    EXPECT_EQ(shared_at_hinge(scene, Side::back), 11U);
    return shared_at_hinge(scene, Side::front);
  };
  EXPECT_EQ(shared_with_wall(-0.5, 1.5, 0), 0U);
  EXPECT_EQ(shared_with_wall(0, 1.5, 0), 0U);
  EXPECT_EQ(shared_with_wall(0, 0.7, 0), 0U);
  EXPECT_EQ(shared_with_wall(0, 0.5, 0), 0U);
  EXPECT_EQ(shared_with_wall(0, 0.3, 0), 11U);
  EXPECT_EQ(shared_with_wall(1, 2, 0), 11U);
  EXPECT_EQ(shared_with_wall(-0.5, 1.5, 0.01), 11U);
}

// A sheet of another paint in the common plane takes no light from either.
TEST(SharedVertices, AThirdPolygonInTheirPlaneDoesNotSeparate) {
  Scene scene = hinge(0);
  scene.materials.resize(2);
  scene.polygons.push_back(scene.polygons[1]);
  scene.polygons[2].material = 1;
  EXPECT_EQ(shared_at_hinge(scene), 11U);
}

TEST(SharedVertices, PositionsCountAndNotIndices) {
  Scene scene = hinge(0);
  scene.vertices.insert(scene.vertices.end(), {scene.vertices[1], scene.vertices[2]});
  scene.polygons[1].corners = {6, 4, 5, 7};
  EXPECT_EQ(shared_at_hinge(scene), 11u);
}

TEST(SharedVertices, AKeptSideSharesWithKeptSidesOnly) {
  const Scene scene = hinge(0);
  KeptSides sides = tiny::both_sides(scene);
  sides.back[1] = 0;
  const PatchMesh mesh = tessellate(scene, sides, 0.1);
  EXPECT_EQ(shared_vertices(mesh, 0, 1), 11u);
  EXPECT_EQ(vertices_of(mesh, 0, Side::back).size(), 121u);
}

TEST(SharedVertices, AClosedPrismIsSmoothAroundButNotAtItsLids) {
  // 16 facets of 22.5 degrees, 1 x n grids; lids with 16 corners.
  std::vector<Point> vertices;
  std::vector<tiny::Corners> polygons(18);
  for (std::uint32_t k = 0; k < 16; ++k) {
    const double angle = k * std::numbers::pi / 8;
    vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    vertices.emplace_back(std::cos(angle), std::sin(angle), 1);
    polygons[k] = {2 * k, (2 * k + 2) % 32, (2 * k + 3) % 32, 2 * k + 1};
    polygons[16].push_back(2 * (15 - k));
    polygons[17].push_back(2 * k + 1);
  }
  const Scene scene = tiny::scene_of(vertices, polygons);
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.2);
  std::set<std::uint32_t> mantle;
  for (PolygonIndex p = 0; p < 16; ++p) {
    for (const std::uint32_t vertex : vertices_of(mesh, p)) mantle.insert(vertex);
    EXPECT_EQ(shared_vertices(mesh, p, (p + 1) % 16), 6u);
    EXPECT_EQ(shared_vertices(mesh, p, 16), 0u);
  }
  // A facet is 2 sin(pi / 16) = 0.39 wide, so it has 2 parts. It is 1 high, so it has 5 parts. 32 columns of 6 points.
  EXPECT_EQ(mantle.size(), 32u * 6);
}

}  // namespace
}  // namespace patchlight::shared_vertices_test
