#include "scene/extent.h"

#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace patchlight::weld_test {
namespace {

std::vector<Point> random_points(std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Point> points;
  for (std::size_t k = 0; k < count; ++k) points.emplace_back(uniform(random), uniform(random), uniform(random));
  return points;
}

TEST(Welded, DoesWhatComparingAllPairsDoes) {
  std::mt19937 random(1);
  // Distances from "hardly any pair" to "nearly all".
  for (const double distance : {0.0, 0.01, 0.1, 0.3, 1.0, 3.0}) {
    const std::vector<Point> points = random_points(400, random);
    const std::vector<std::uint32_t> found = welded(points, distance);
    for (std::uint32_t v = 0; v < points.size(); ++v) {
      std::uint32_t first = v;
      for (std::uint32_t k = v; k-- > 0;) {
        if (found[k] == k && (points[k] - points[v]).norm() <= distance) first = k;
      }
      ASSERT_EQ(found[v], first) << "distance " << distance << ", point " << v;
    }
  }
}

TEST(Welded, EqualPointsAreOneAtAnyDistanceAndPlace) {
  for (const double at : {0.0, 1.0, 1e9, 1e300}) {
    for (const double distance : {0.0, 1e-300, 1e-9}) {
      const std::vector<Point> points = {Point(at, 0, 0), Point(0, at, 1), Point(at, 0, 0)};
      EXPECT_EQ(welded(points, distance), (std::vector<std::uint32_t>{0, 1, 0}));
    }
  }
  EXPECT_TRUE(welded({}, 1).empty());
}

TEST(Welded, ADistanceWhoseInverseIsInfiniteIsADistance) {
  const double distance = std::numeric_limits<double>::denorm_min();
  const std::vector<Point> points = {Point(0, 0, 0), Point(1e-150, 0, 0), Point(0, 0, 0)};
  EXPECT_EQ(welded(points, distance), (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(WeldDistance, IsAMillionthOfTheExtentUnlessTheOriginIsFar) {
  EXPECT_DOUBLE_EQ(weld_distance(Box(Point(0, 0, 0), Point(1, 5, 2))), 5e-6);
  EXPECT_DOUBLE_EQ(weld_distance(Box(Point(0, 0, 0), Point(1e-3, 5e-3, 2e-3))), 5e-9);
  // 1e12 m away doubles are 1.2e-4 m apart.
  EXPECT_GT(weld_distance(Box(Point(1e12, 0, 0), Point(1e12 + 1, 5, 2))), 1e-4);
  EXPECT_EQ(weld_distance(Box()), 0);
}

}  // namespace
}  // namespace patchlight::weld_test
