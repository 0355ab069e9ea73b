#include "scene/face_tree.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace patchlight::section_test {
namespace {

double length_of(const std::vector<std::array<Point, 2>>& pieces) {
  double length = 0;
  for (const auto& [from, to] : pieces) length += (to - from).norm();
  return length;
}

// A horizontal plane cuts the four walls of a box of 4 x 3 x 2.5 m along 14 m. Above the box it cuts nothing.
TEST(Section, OfABoxIsItsOutline) {
  const Scene scene = test::with_box(test::empty_scene({test::grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  const auto pieces = section_of(scene, Point(9, 9, 1), Vector::UnitZ());
  ASSERT_EQ(pieces.size(), 4U);
  EXPECT_NEAR(length_of(pieces), 14, 1e-12);
  for (const auto& [from, to] : pieces) EXPECT_NEAR(from.z() + to.z(), 2, 1e-12);
  EXPECT_TRUE(section_of(scene, Point(0, 0, 3), Vector::UnitZ()).empty());
}

// A vertical wall of 5 x 3 m with a door of 1 x 2 m on its lower edge, and a window joined to the outline by a seam. At
// 1.5 m the wall is cut beside both, at 2.5 m along its whole length.
TEST(Section, LeavesOutDoorsAndHoles) {
  const std::vector<Point> wall = {Point(0, 0, 0), Point(1, 0, 0), Point(1, 0, 2), Point(2, 0, 2), Point(2, 0, 0),
                                   Point(5, 0, 0), Point(5, 0, 3), Point(3, 0, 2), Point(4, 0, 2), Point(4, 0, 1),
                                   Point(3, 0, 1), Point(3, 0, 2), Point(5, 0, 3), Point(0, 0, 3)};
  const Scene scene = test::with_polygon(test::empty_scene({test::grey(0.5)}), wall);
  EXPECT_NEAR(length_of(section_of(scene, Point(0, 0, 1.5), Vector::UnitZ())), 3, 1e-12);
  EXPECT_NEAR(length_of(section_of(scene, Point(0, 0, 2.5), Vector::UnitZ())), 5, 1e-12);
}

}  // namespace
}  // namespace patchlight::section_test
