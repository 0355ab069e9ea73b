#include "input/joined_rings.h"

#include <gtest/gtest.h>

namespace patchlight::joined_rings_test {
namespace {

double area_of_walk(const std::vector<std::vector<Eigen::Vector2d>>& rings, const std::vector<RingCorner>& walk) {
  double twice = 0;
  for (std::size_t k = 0; k < walk.size(); ++k) {
    const auto& [ra, a] = walk[k];
    const auto& [rb, b] = walk[(k + 1) % walk.size()];
    twice += rings[ra][a].x() * rings[rb][b].y() - rings[ra][a].y() * rings[rb][b].x();
  }
  return twice / 2;
}

// A square of 7 with nine windows of 1 close together: all are joined, and the walk's area is what they leave.
TEST(JoinedRings, ReachHolesBehindOthers) {
  using Ring = std::vector<Eigen::Vector2d>;
  const auto square = [](double x, double y, double edge) {
    return Ring{{x, y}, {x + edge, y}, {x + edge, y + edge}, {x, y + edge}};
  };
  std::vector<Ring> rings = {square(0, 0, 7)};
  for (const int k : {4, 0, 1, 2, 3, 5, 6, 7, 8}) rings.push_back(square(1.9 + 1.1 * (k % 3), 1.9 + 1.1 * (k / 3), 1));
  const auto walk = joined_rings(rings);
  ASSERT_TRUE(walk.has_value());
  EXPECT_NEAR(area_of_walk(rings, *walk), 49 - 9, 1e-12);
  EXPECT_EQ(walk->size(), 4U + 9 * (4 + 2));
  EXPECT_FALSE(joined_rings({square(0, 0, 1), Ring{{0, 0}, {1, 0}}}).has_value());
}

}  // namespace
}  // namespace patchlight::joined_rings_test
