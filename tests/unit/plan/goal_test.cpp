#include "plan/goal.h"

#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "support/daylight_office.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

namespace patchlight::goal_test {
namespace {

using namespace test;

// The office with a ground of this many meters on each side, by sun and sky alone, and two sensors.
Scene office_on(double ground) {
  Scene scene = daylight_office();
  scene.luminaires.clear();
  const Polygon& polygon = scene.polygons.back();
  const double x[] = {2 - ground, 2 + ground, 2 + ground, 2 - ground};
  const double y[] = {-ground, -ground, -0.1, -0.1};
  for (std::size_t k = 0; k < 4; ++k) scene.vertices[polygon.corners[k]] = Point(x[k], y[k], -0.2);
  scene.sensors = {
      {.name = "desk", .sensors = {{Point(0.6, 1.5, 0.9), Vector::UnitZ()}, {Point(3, 4.2, 0.9), Vector::UnitZ()}}}};
  return scene;
}

std::shared_ptr<const Goal> goal_of(const Scene& scene) {
  const KeptSides sides = kept_sides(scene, Sides::automatic);
  return find_goal(scene, sides, find_coverings(scene, sides), {}, 1);
}

TEST(Goal, IsTheRoomAndNotTheGround) {
  const Scene scene = office_on(300);
  const auto goal = goal_of(scene);
  ASSERT_TRUE(goal);
  EXPECT_EQ(goal->is_goal.back(), 0);
  for (PolygonIndex p = 0; p < 6; ++p) EXPECT_EQ(goal->is_goal[p], 1) << p;
  EXPECT_GT(goal->share_of_surroundings, 0);
  EXPECT_LE(goal->share_of_surroundings, 0.5);
  for (const ImportanceHit& hit : goal->hits) EXPECT_EQ(goal->is_goal[hit.at.polygon], 0);
}

TEST(Goal, IsEverythingWithoutDaylight) {
  Scene scene = office_on(30);
  scene.sun.reset();
  scene.sky.reset();
  EXPECT_FALSE(goal_of(scene));
}

// A path of 200 km would take 10^5 patches as long as it is wide.
TEST(Goal, LeavesALongPathInFewPatches) {
  Scene scene = office_on(30);
  for (std::size_t k = 0; k < 4; ++k) {
    Point& corner = scene.vertices[scene.polygons.back().corners[k]];
    corner = Point(corner.x() < 2 ? -1e5 : 1e5, corner.y() < -1 ? -1 : -0.1, -0.2);
  }
  const auto goal = goal_of(scene);
  ASSERT_TRUE(goal);
  const auto path = static_cast<PolygonIndex>(scene.polygons.size() - 1);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::automatic), edges_for(scene, 0.5, goal.get()));
  for (const Side side : {Side::front, Side::back}) {
    const auto [begin, end] = mesh.patches_on(path, side);
    EXPECT_LE(end - begin, 1024U);
  }
}

// Patches close to the window matter most, and are cut first. The ground gets 200 patches more than its outline takes,
// and at most as many again by balance.
TEST(Goal, CutsTheGroundBeforeTheWindow) {
  const Scene scene = office_on(300);
  const KeptSides sides = kept_sides(scene, Sides::automatic);
  const auto goal = goal_of(scene);
  ASSERT_TRUE(goal);
  const PatchMesh mesh = cut_by_importance(tessellate(scene, sides, edges_for(scene, 0.5, goal.get())), *goal, 200);
  double nearest = 1e9;
  double size_of_nearest = 0;
  double largest = 0;
  std::size_t count = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (goal->is_goal[mesh.polygon[i]] != 0) continue;
    ++count;
    largest = std::max(largest, std::sqrt(mesh.area[i]));
    const double distance = (mesh.centroid[i] - Point(2, -2, -0.2)).norm();
    if (distance < nearest) nearest = distance, size_of_nearest = std::sqrt(mesh.area[i]);
  }
  EXPECT_GE(count, 200U);
  EXPECT_LT(count, 400U);
  EXPECT_LT(size_of_nearest, 5);
  EXPECT_GT(largest, 10 * size_of_nearest);
}

// Ground beyond 40 m changes little of the light in the room. From the middle of the pane, 1.7 m above the ground, it
// covers sin(atan(1.7 / 40)) / 2 = 2.1 % of the cosine-weighted hemisphere. So the readings agree to 3 % in addition to
// their errors.
TEST(Goal, KeepsTheRoomAsItIsInAWideTerrain) {
  Request request;
  request.mesh.patches = 1500;
  request.accuracy.error_bars = true;
  const auto readings = [&](double ground) {
    const Scene scene = office_on(ground);
    return read_sensors(simulate(scene, request)).readings;
  };
  const Readings near = readings(40);
  const Readings far = readings(400);
  for (Eigen::Index k = 0; k < 2; ++k) {
    const double difference = std::abs(near.irradiance(k, 0) - far.irradiance(k, 0));
    EXPECT_LT(difference,
              3 * std::hypot(near.standard_error(k, 0), far.standard_error(k, 0)) + 0.03 * near.irradiance(k, 0))
        << k;
    EXPECT_LT(far.standard_error(k, 0), 0.2 * far.irradiance(k, 0)) << k;
  }
}

}  // namespace
}  // namespace patchlight::goal_test
