// Geometry of many corners and faces, which uses trees. tests/benchmarks/growth.py measures the time.
#include "scene/coverings.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"
#include "support/large_shapes.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace patchlight::large_test {
namespace {

using namespace test;

KeptSides both_sides(const Scene& scene) { return kept_sides(scene, Sides::both); }

// Triangles that cover the polygon: their areas add up to its area, with rounding of 1e-16 for each of 10,000. A
// polygon of n corners has n - 2 (Meisters 1975).
TEST(Large, TheTrianglesOfADiscCoverIt) {
  const std::vector<Point> outline = disc(10000);
  const auto triangles = triangulate(outline);
  EXPECT_EQ(triangles.size(), outline.size() - 2);
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    sum += area_vector(std::vector<Point>{outline[a], outline[b], outline[c]}).z();
  }
  EXPECT_NEAR(sum, area_vector(outline).norm(), 1e-11);
}

// One swapped pair of neighbors causes a crossing.
TEST(Large, ACrossingIsFoundAmongManyEdges) {
  std::vector<Point> outline = disc(10000);
  EXPECT_FALSE(crosses_itself(outline));
  std::swap(outline[7000], outline[7001]);
  EXPECT_TRUE(crosses_itself(outline));
}

TEST(Large, FacesOnOneEdgeDoNotCoverEachOther) {
  const Scene scene = book(4000);
  EXPECT_TRUE(find_coverings(scene, both_sides(scene)).over.empty());
}

// The oracle: all pairs of a few hundred quadrilaterals in a few planes, clipped against each other.
TEST(Large, CoveringsAreThoseOfAllPairs) {
  std::mt19937 chance(1);
  std::uniform_real_distribution<double> place(0, 3);
  std::uniform_int_distribution<int> plane(0, 3);
  Scene scene = empty_scene({grey(0.5)});
  for (int k = 0; k < 150; ++k) {
    const double x = place(chance), y = place(chance), width = place(chance) / 2 + 0.1, depth = place(chance) / 2 + 0.1;
    Quad quad{Point(x, y, 0), Point(x + width, y, 0), Point(x + width, y + depth, 0), Point(x, y + depth, 0)};
    const Eigen::AngleAxisd tilt(0.5 * plane(chance), Vector::UnitX());
    for (Point& corner : quad) corner = tilt * corner;
    scene = with_quad(std::move(scene), quad);
  }
  const Coverings found = find_coverings(scene, both_sides(scene));
  std::size_t pairs = 0;
  for (PolygonIndex lower = 0; lower < scene.polygons.size(); ++lower) {
    const std::vector<Point> below = corner_points(scene, lower);
    const Vector normal = front_normal(scene, lower);
    std::vector<PolygonIndex> expected;
    for (PolygonIndex upper = 0; upper < scene.polygons.size(); ++upper) {
      std::vector<Point> left = corner_points(scene, upper);
      if (upper == lower || area_vector(left).norm() > area_vector(below).norm()) continue;
      if (std::any_of(left.begin(), left.end(),
                      [&](const Point& p) { return std::abs(normal.dot(p - below[0])) > 1e-9; }))
        continue;
      for (std::size_t k = 0; k < 4 && !left.empty(); ++k)
        left = clip_to_half_space(left, below[k], normal.cross(below[(k + 1) % 4] - below[k]));
      if (area_vector(left).norm() > 1e-5) expected.push_back(upper);
    }
    const auto over = found.over_side(lower, Side::front);
    EXPECT_EQ(std::vector<PolygonIndex>(over.begin(), over.end()), expected) << lower;
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 100U);
}

}  // namespace
}  // namespace patchlight::large_test
