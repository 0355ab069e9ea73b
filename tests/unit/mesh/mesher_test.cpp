#include "mesh/mesher.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "support/polygon_shapes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace patchlight::mesher_test {
namespace {

using tiny::Shape;

double longest_edge(const PatchMesh& mesh) {
  double longest = 0;
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const PatchCorners corners = mesh.corner_points(patch);
    const std::size_t n = static_cast<std::size_t>(corners.count);
    for (std::size_t k = 0; k < n; ++k) {
      longest = std::max(longest, (corners.points[(k + 1) % n] - corners.points[k]).norm());
    }
  }
  return longest;
}

std::set<std::array<double, 3>> corner_set(const PatchMesh& mesh, PatchIndex patch) {
  std::set<std::array<double, 3>> points;
  for (const std::uint32_t vertex : mesh.corners[patch]) {
    const Point& point = mesh.vertices[vertex];
    points.insert({point.x(), point.y(), point.z()});
  }
  return points;
}

// 1 inside, 0 outside: the sum of the angles subtended by the edges.
int winding_number(const std::vector<Point>& polygon, const Vector& normal, const Point& eye) {
  double angle = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector a = polygon[k] - eye;
    const Vector b = polygon[(k + 1) % polygon.size()] - eye;
    angle += std::atan2(normal.dot(a.cross(b)), a.dot(b));
  }
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

bool same_bits(const PatchMesh& a, const PatchMesh& b) {
  return a.vertices == b.vertices && a.corners == b.corners && a.centroid == b.centroid && a.normal == b.normal &&
         a.area == b.area && a.material == b.material && a.polygon == b.polygon && a.side == b.side &&
         a.first_patch == b.first_patch;
}

class EveryShape : public testing::TestWithParam<std::tuple<Shape, double>> {
 protected:
  const Scene& scene() const { return std::get<0>(GetParam()).scene; }
  double max_edge() const { return std::get<1>(GetParam()); }
};

// Without the slivers, whose patches depend on rounding.
class EveryPlumpShape : public EveryShape {};

std::vector<Shape> plump_shapes() {
  std::vector<Shape> shapes = tiny::polygon_shapes();
  std::erase_if(shapes, [](const Shape& shape) { return shape.thickness < 1; });
  return shapes;
}

TEST_P(EveryShape, KeepsTheArea) {
  const PatchMesh mesh = tessellate(scene(), tiny::both_sides(scene()), max_edge());
  const double area = area_vector(corner_points(scene(), 0)).norm();
  // Points are rounded by about 1e-16 of the diameter d (below 5). Over a boundary of at most 4 d this adds up to less
  // than 1e-15 d^2.
  const double tolerance = 1e-12 * area + 1e-15 * bounds(scene()).diagonal().squaredNorm();
  for (const Side side : {Side::front, Side::back}) {
    const PatchRange range = mesh.patches_on(0, side);
    double sum = 0;
    for (PatchIndex patch = range.begin; patch < range.end; ++patch) sum += mesh.area[patch];
    EXPECT_NEAR(sum, area, tolerance);
  }
}

TEST_P(EveryShape, HasNoEdgeLongerThanWanted) {
  const PatchMesh mesh = tessellate(scene(), tiny::front_sides(scene()), max_edge());
  EXPECT_LE(longest_edge(mesh), max_edge() * (1 + 1e-9));
}

TEST_P(EveryShape, PatchesAreConvexAndCounterClockwiseInsideThePolygon) {
  const PatchMesh mesh = tessellate(scene(), tiny::both_sides(scene()), max_edge());
  const std::vector<Point> polygon = corner_points(scene(), 0);
  const Vector front = front_normal(scene(), 0);
  ASSERT_GT(mesh.size(), 0u);
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const Vector& normal = mesh.normal[patch];
    EXPECT_EQ(normal, mesh.side[patch] == Side::front ? front : Vector(-front));
    EXPECT_GT(mesh.area[patch], 0);
    const PatchCorners corners = mesh.corner_points(patch);
    const std::size_t n = static_cast<std::size_t>(corners.count);
    for (std::size_t k = 0; k < n; ++k) {
      const Vector edge = corners.points[(k + 1) % n] - corners.points[k];
      const Vector next = corners.points[(k + 2) % n] - corners.points[(k + 1) % n];
      // A straight corner of the polygon may turn backward by rounding.
      EXPECT_GE(normal.dot(edge.cross(next)), -1e-14 * edge.norm() * next.norm());
    }
    EXPECT_EQ(winding_number(polygon, front, mesh.centroid[patch]), 1);
  }
}

TEST_P(EveryShape, BothSidesCoincideWithTheirOwnVertices) {
  const PatchMesh mesh = tessellate(scene(), tiny::both_sides(scene()), max_edge());
  const PatchRange front = mesh.patches_on(0, Side::front);
  const PatchRange back = mesh.patches_on(0, Side::back);
  ASSERT_EQ(front.end - front.begin, back.end - back.begin);
  std::set<std::uint32_t> front_vertices;
  for (PatchIndex k = 0; k < front.end; ++k) {
    const PatchIndex other = back.begin + k;
    front_vertices.insert(mesh.corners[k].begin(), mesh.corners[k].end());
    EXPECT_EQ(corner_set(mesh, k), corner_set(mesh, other));
    EXPECT_EQ(mesh.normal[k], -mesh.normal[other]);
    // The same area from corners in another order: rounding relative to the squared edges, at most max_edge^2.
    EXPECT_NEAR(mesh.area[k], mesh.area[other], 1e-15 * max_edge() * max_edge());
  }
  for (PatchIndex k = back.begin; k < back.end; ++k) {
    for (const std::uint32_t vertex : mesh.corners[k]) EXPECT_FALSE(front_vertices.contains(vertex));
  }
}

TEST_P(EveryPlumpShape, IsTheSameAfterRigidMotionAndScaling) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Vector(3, -1, 2).normalized()).toRotationMatrix();
  const double scale = 3.7;
  const Scene other_scene = tiny::moved(scene(), turn, scale, {5, 6, -7});
  const PatchMesh mesh = tessellate(scene(), tiny::front_sides(scene()), max_edge());
  const PatchMesh other = tessellate(other_scene, tiny::front_sides(other_scene), scale * max_edge());
  ASSERT_EQ(mesh.size(), other.size());
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    // Positions of about 10 units are rounded by 1e-15. The smallest patches have about 1e-4 units^2.
    EXPECT_NEAR(other.area[patch], scale * scale * mesh.area[patch], 1e-9 * other.area[patch]);
  }
}

TEST_P(EveryShape, NeighboursInsideMeetEdgeToEdge) {
  const PatchMesh mesh = tessellate(scene(), tiny::front_sides(scene()), max_edge());
  // Euler's formula for a disk (V - E + F = 1), with E counted from the patches, holds only without T-junctions.
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::set<std::uint32_t> vertices;
  for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
    const std::size_t n = static_cast<std::size_t>(mesh.corner_points(patch).count);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t from = mesh.corners[patch][k], to = mesh.corners[patch][(k + 1) % n];
      edges.insert(std::minmax(from, to));
      vertices.insert(from);
    }
  }
  EXPECT_EQ(vertices.size(), mesh.vertices.size());
  // The ring's slit is merged along its length, which makes it a true ring: V - E + F = 0.
  const int euler = std::get<0>(GetParam()).name == "ring_with_slit" ? 0 : 1;
  EXPECT_EQ(static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.size()), euler);
}

std::string name_of(const testing::TestParamInfo<std::tuple<Shape, double>>& instance) {
  return std::get<0>(instance.param).name + "_" + std::to_string(instance.index % 4);
}

INSTANTIATE_TEST_SUITE_P(Mesher, EveryShape,
                         testing::Combine(testing::ValuesIn(tiny::polygon_shapes()),
                                          testing::Values(10.0, 0.4, 0.1, 0.03)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Mesher, EveryPlumpShape,
                         testing::Combine(testing::ValuesIn(plump_shapes()), testing::Values(10.0, 0.4, 0.1, 0.03)),
                         name_of);

TEST(Mesher, QuadsStayQuadsAndTrianglesStayTriangles) {
  const Scene box = tiny::box({2, 1, 1});
  const PatchMesh quads = tessellate(box, tiny::front_sides(box), 0.25);
  EXPECT_EQ(quads.size(), 2u * (8 * 4 + 8 * 4 + 4 * 4));
  for (PatchIndex patch = 0; patch < quads.size(); ++patch) {
    EXPECT_EQ(quads.corner_points(patch).count, 4);
    EXPECT_NEAR(quads.area[patch], 0.0625, 1e-15);
  }
  const Scene equilateral = tiny::polygon({{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}});
  const PatchMesh triangles = tessellate(equilateral, tiny::front_sides(equilateral), 0.1);
  EXPECT_EQ(triangles.size(), 100u);
  for (PatchIndex patch = 0; patch < triangles.size(); ++patch) {
    EXPECT_EQ(triangles.corner_points(patch).count, 3);
    EXPECT_NEAR(triangles.area[patch], std::sqrt(0.75) / 200, 1e-15);
  }
}

TEST(Mesher, TrianglesAreWellShaped) {
  // Triangles are equilateral except near the boundary, where halving the longest edge of Delaunay triangles leaves
  // over 20 degrees.
  const double least_sine = std::sin(20 * std::numbers::pi / 180);
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    if (shape.name != "trapezoid" && shape.name != "l_shape" && shape.name != "hexagon") continue;
    const PatchMesh mesh = tessellate(shape.scene, tiny::front_sides(shape.scene), 0.05);
    for (PatchIndex patch = 0; patch < mesh.size(); ++patch) {
      const auto& [a, b, c, unused] = mesh.corner_points(patch).points;
      const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
      // Twice the area is the product of two sides and the sine of the angle between them. The smallest angle is
      // between the longest two.
      EXPECT_GE(2 * mesh.area[patch] * std::min({ab, bc, ca}) / (ab * bc * ca), least_sine) << shape.name;
    }
  }
}

TEST(Mesher, MeshesAnyStarShapedPolygon) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t n = 3 + trial % 8;
    const double squashed = trial % 5 == 0 ? 1e-5 : 1;
    std::vector<Point> corners;
    for (std::size_t k = 0; k < n; ++k) {
      const double angle =
          2 * std::numbers::pi * (static_cast<double>(k) + 0.9 * share(random)) / static_cast<double>(n);
      const double radius = 0.1 + share(random);
      corners.emplace_back(radius * std::cos(angle), squashed * radius * std::sin(angle), 0);
    }
    const Scene scene = tiny::polygon(corners);
    const double signed_area = area_vector(corners).z();
    if (signed_area <= 0) continue;  // three corners need not enclose the middle
    const double max_edge = std::exp(-4 * share(random));
    const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), max_edge);
    double sum = 0;
    for (const double area : mesh.area) {
      EXPECT_GT(area, 0) << "trial " << trial;
      sum += area;
    }
    EXPECT_NEAR(sum, signed_area, 1e-12 * signed_area + 1e-15) << "trial " << trial;
    EXPECT_LE(longest_edge(mesh), max_edge * (1 + 1e-9)) << "trial " << trial;
  }
}

TEST(Mesher, EndsForASelfIntersectingPolygon) {
  // Two triangles of 3.375 and 0.375 m^2 touch crosswise, with opposite orientation. No mesh is correct, but no patch
  // is inverted. The area is between the difference of both areas and their sum.
  const Scene scene = tiny::polygon({{0, 0, 0}, {3, 3, 0}, {3, 0, 0}, {0, 1, 0}});
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.05);
  double sum = 0;
  for (const double area : mesh.area) {
    EXPECT_GT(area, 0);
    sum += area;
  }
  EXPECT_GE(sum, area_vector(corner_points(scene, 0)).norm() - 1e-12);
  EXPECT_LE(sum, 3.75 + 1e-12);
}

TEST(Mesher, DoesNotDependOnTheNumberOfThreads) {
  Scene scene = tiny::in_triangles(tiny::box({4, 3, 2.5}));
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return tessellate(scene, tiny::both_sides(scene), 0.11);
  };
  EXPECT_TRUE(same_bits(with_threads(1), with_threads(2)));
}

TEST(Mesher, KeepsOnlyTheSidesAskedFor) {
  const Scene box = tiny::box({1, 1, 1});
  KeptSides sides = tiny::front_sides(box);
  sides.front[2] = 0;
  sides.back[4] = 1;
  const PatchMesh mesh = tessellate(box, sides, 0.5);
  EXPECT_EQ(mesh.size(), 6u * 4);
  for (PolygonIndex p = 0; p < 6; ++p) {
    EXPECT_EQ(mesh.patches_on(p, Side::front).end - mesh.patches_on(p, Side::front).begin, p == 2 ? 0u : 4u);
    EXPECT_EQ(mesh.patches_on(p, Side::back).end - mesh.patches_on(p, Side::back).begin, p == 4 ? 4u : 0u);
  }
}

TEST(Mesher, RefusesMorePatchesThanIndices) {
  const Scene box = tiny::box({1, 1, 1});
  EXPECT_THROW(tessellate(box, tiny::front_sides(box), 1e-6), MemoryError);
  EXPECT_THROW(max_edge_for(box, tiny::front_sides(box), std::size_t{1} << 40), MemoryError);
}

}  // namespace
}  // namespace patchlight::mesher_test
