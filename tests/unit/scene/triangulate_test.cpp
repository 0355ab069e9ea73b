#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace patchlight::triangulate_test {
namespace {

using Outline = std::vector<Point>;

Outline flat(const std::vector<std::pair<double, double>>& corners) {
  Outline outline;
  for (const auto& [x, y] : corners) outline.emplace_back(x, y, 0);
  return outline;
}

// A star with `points` tips, radius 2 at the tips and 1 between them.
Outline star(int points) {
  Outline outline;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = std::numbers::pi * k / points;
    const double radius = k % 2 == 0 ? 2 : 1;
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return outline;
}

std::map<std::string, Outline> outlines() {
  return {{"triangle", flat({{0, 0}, {1, 0}, {0, 1}})},
          {"square", flat({{0, 0}, {1, 0}, {1, 1}, {0, 1}})},
          {"dart", flat({{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}})},
          {"L", flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})},
          {"wall with a door", flat({{0, 0}, {1, 0}, {1, 2}, {2, 2}, {2, 0}, {3, 0}, {3, 3}, {0, 3}})},
          {"comb", flat({{0, 0},
                         {7, 0},
                         {7, 3},
                         {6, 3},
                         {6, 1},
                         {5, 1},
                         {5, 3},
                         {4, 3},
                         {4, 1},
                         {3, 1},
                         {3, 3},
                         {2, 3},
                         {2, 1},
                         {1, 1},
                         {1, 3},
                         {0, 3}})},
          {"square with a corner on a side", flat({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}})},
          {"frame cut open", flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}})},
          {"star", star(7)}};
}

// Rotated and moved in space, a few sizes from the origin.
Outline moved(const Outline& outline) {
  const Eigen::AngleAxisd rotation(0.7, Vector(1, -2, 0.5).normalized());
  Outline result;
  for (const Point& p : outline) result.push_back(rotation * p + Vector(10, -20, 5));
  return result;
}

// A polygon with n corners gives n - 2 triangles. Each has the polygon's orientation or no area, so equal areas imply a
// cover without gaps and overlaps.
TEST(Triangulate, CoversThePolygonWithTrianglesOfItsOrientation) {
  // Areas of about 10 are sums of products of coordinates up to 20: 1e-13 is a few hundred roundings.
  constexpr double rounding = 1e-13 * 20 * 20;
  for (const auto& [name, flat_outline] : outlines()) {
    SCOPED_TRACE(name);
    Outline reversed = flat_outline;
    std::reverse(reversed.begin(), reversed.end());
    for (const Outline& outline : {flat_outline, reversed, moved(flat_outline)}) {
      const Vector whole = area_vector(outline);
      const auto triangles = triangulate(outline);
      EXPECT_EQ(triangles.size(), outline.size() - 2);
      double sum = 0;
      for (const auto& [a, b, c] : triangles) {
        const Vector area = area_vector(std::vector<Point>{outline[a], outline[b], outline[c]});
        EXPECT_GE(area.dot(whole.normalized()), -rounding);
        sum += area.norm();
      }
      EXPECT_NEAR(sum, whole.norm(), rounding);
    }
  }
}

TEST(Triangulate, StartingAtAnotherCornerStillCovers) {
  for (const auto& [name, outline] : outlines()) {
    SCOPED_TRACE(name);
    Outline turned = outline;
    for (std::size_t k = 0; k < outline.size(); ++k) {
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      double sum = 0;
      for (const auto& [a, b, c] : triangulate(turned)) {
        sum += area_vector(std::vector<Point>{turned[a], turned[b], turned[c]}).norm();
      }
      EXPECT_NEAR(sum, area_vector(outline).norm(), 1e-13);
    }
  }
}

TEST(Triangulate, CutsConvexQuadrilateralsAlongTheShorterDiagonal) {
  const Outline kite = flat({{0, 0}, {1, -0.2}, {5, 0}, {1, 0.2}});
  for (const auto& triangle : triangulate(kite)) {
    EXPECT_TRUE(std::count(triangle.begin(), triangle.end(), 1U) && std::count(triangle.begin(), triangle.end(), 3U));
  }
}

TEST(IsConvex, TellsConvexFromConcave) {
  const auto outline = outlines();
  for (const char* name : {"triangle", "square", "square with a corner on a side"}) {
    EXPECT_TRUE(is_convex(outline.at(name))) << name;
  }
  for (const char* name : {"dart", "L", "wall with a door", "comb", "star"}) {
    EXPECT_FALSE(is_convex(outline.at(name))) << name;
  }
}

}  // namespace
}  // namespace patchlight::triangulate_test
