#include "scene/room_body.h"

#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::room_body_test {
namespace {

// An L: a square of 2 m without its upper right quarter, 1 m high, as an extruded floor plan.
std::vector<std::vector<Point>> l_shape() {
  const std::vector<Point> plan = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  const Vector up = Vector::UnitZ();
  std::vector<std::vector<Point>> faces(2);
  for (std::size_t k = 0; k < plan.size(); ++k) {
    const Point& next = plan[(k + 1) % plan.size()];
    faces.push_back({plan[k], next, next + up, plan[k] + up});
    faces[1].push_back(plan[k] + up);
  }
  faces[0].assign(plan.rbegin(), plan.rend());
  return faces;
}

void expect_l_shape(const RoomBody& body) {
  EXPECT_TRUE(body.holds({0.5, 0.5, 0.5}));
  EXPECT_TRUE(body.holds({1.9, 0.9, 0.1}));
  EXPECT_TRUE(body.holds({0.1, 1.9, 0.9}));
  EXPECT_FALSE(body.holds({1.5, 1.5, 0.5}));  // in the bounding box
  EXPECT_FALSE(body.holds({0.5, 0.5, 1.1}));
  EXPECT_FALSE(body.holds({-1, 0.5, 0.5}));
}

TEST(RoomBody, HoldsWhatIsInAnLAndNotInItsNook) { expect_l_shape(RoomBody(l_shape())); }

TEST(RoomBody, ThatIsTurnedInsideOutHoldsTheSame) {
  std::vector<std::vector<Point>> faces = l_shape();
  for (std::vector<Point>& face : faces) std::reverse(face.begin(), face.end());
  expect_l_shape(RoomBody(faces));
}

// The orientation of a wall between two rooms in one of them.
TEST(RoomBody, WithOneFaceTurnedHoldsTheSame) {
  for (std::size_t turned = 0; turned < l_shape().size(); ++turned) {
    std::vector<std::vector<Point>> faces = l_shape();
    std::reverse(faces[turned].begin(), faces[turned].end());
    expect_l_shape(RoomBody(faces));
  }
}

TEST(RoomBody, WithoutFacesHoldsNothing) { EXPECT_FALSE(RoomBody({}).holds({0, 0, 0})); }

}  // namespace
}  // namespace patchlight::room_body_test
