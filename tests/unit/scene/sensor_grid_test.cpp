#include "scene/sensor_grid.h"

#include "support/scenes.h"

#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::sensor_grid_test {
namespace {

using namespace test;

double area_of(const SensorGroup& group) {
  double area = 0;
  for (const auto& cell : group.cells) area += area_vector(cell).norm();
  return area;
}

TEST(RectangleGrid, CellsFillTheRectangleWithASensorInTheMiddleOfEach) {
  const SensorGroup grid = rectangle_grid(Point(1, 2, 3), {Vector(2, 0, 0), Vector(0, 0.9, 0)}, 0.5);
  ASSERT_EQ(grid.sensors.size(), 8U);
  EXPECT_NEAR(area_of(grid), 1.8, 1e-14);
  for (std::size_t k = 0; k < grid.sensors.size(); ++k) {
    EXPECT_LT((area_centroid(grid.cells[k]) - grid.sensors[k].point).norm(), 1e-14);
    EXPECT_EQ(grid.sensors[k].normal, Vector(0, 0, 1));
  }
}

TEST(CellsAlong, RoundingMakesNoCellMore) {
  EXPECT_EQ(cells_along(0.1 + 0.2, 0.1), 3);  // 3.0000000000000004 cells
  EXPECT_EQ(cells_along(0.31, 0.1), 4);
  EXPECT_EQ(cells_along(0.01, 0.1), 1);
}

// An L of 4 x 4 m without a quarter, in two polygons, turned by 30 degrees: with cells of 0.5 m none is cut.
TEST(FloorGrid, CoversTheFloorOfAnyShapeAndTurn) {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(4, 0, 1), Point(4, 2, 1), Point(0, 2, 1)});
  scene = with_quad(std::move(scene), {Point(0, 2, 1), Point(2, 2, 1), Point(2, 4, 1), Point(0, 4, 1)});
  scene = with_quad(std::move(scene), {Point(0, 0, 3), Point(4, 0, 3), Point(4, 2, 3), Point(0, 2, 3)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(4, 0, 1), Point(4, 0, 3), Point(0, 0, 3)});
  const Eigen::Affine3d turn(Eigen::AngleAxisd(std::numbers::pi / 6, Vector::UnitZ()));
  scene = moved(std::move(scene), turn);
  const std::vector<PolygonIndex> all = {0, 1, 2, 3};
  const Floor floor = floor_of(outlines_of(scene, all), scene.up);
  EXPECT_EQ(floor.outlines.size(), 2U);
  EXPECT_NEAR(area_of(floor), 12, 1e-12);
  const SensorGroup grid = floor_grid(floor, 0.8, 0.5, 0);
  EXPECT_EQ(grid.sensors.size(), 48U);
  for (const Sensor& sensor : grid.sensors) {
    EXPECT_NEAR(sensor.point.z(), 1.8, 1e-14);
    const Point back = turn.inverse() * sensor.point;
    EXPECT_FALSE(back.x() > 2 && back.y() > 2);
  }
}

// 40 x 28 m in two triangles, turned by 30 degrees: rows go along its edges, not along the longer diagonal.
TEST(FloorGrid, StandsParallelToTheRimOfATriangulatedFloor) {
  const Eigen::Affine3d turn(Eigen::AngleAxisd(std::numbers::pi / 6, Vector::UnitZ()));
  std::vector<std::vector<Point>> faces = {{Point(0, 0, 0), Point(40, 0, 0), Point(40, 28, 0)},
                                           {Point(0, 0, 0), Point(40, 28, 0), Point(0, 28, 0)}};
  for (std::vector<Point>& face : faces)
    for (Point& corner : face) corner = turn * corner;
  const Floor floor = floor_of(faces, Vector::UnitZ());
  EXPECT_EQ(floor_grid(floor, 0, 2, 0).sensors.size(), 20U * 14);
  const Vector along = (turn.inverse().linear() * rectangle_over(floor, 0)[1]).normalized();
  EXPECT_NEAR(std::max(std::abs(along.x()), std::abs(along.y())), 1, 1e-12);
}

// Middles lie at 0.25, 0.75, ... from the walls of 4 x 3 m: 0.5 m from them 6 x 4 are left.
TEST(FloorGrid, KeepsADistanceFromWalls) {
  const Floor floor{{{Point(0, 0, 0), Point(4, 0, 0), Point(4, 3, 0), Point(0, 3, 0)}}, Vector::UnitZ()};
  EXPECT_EQ(floor_grid(floor, 0.8, 0.5, 0.5).sensors.size(), 6U * 4);
  EXPECT_TRUE(floor_grid(floor, 0.8, 0.5, 1.6).sensors.empty());
}

// One walks on the top of a slab, not on its underside; the ceiling of a room is no top of its floor.
TEST(FloorOf, ASlabIsItsTop) {
  const auto level = [](double height) {
    return std::vector<Point>{Point(0, 0, height), Point(4, 0, height), Point(4, 3, height), Point(0, 3, height)};
  };
  EXPECT_EQ(floor_of({level(-0.2), level(0)}, Vector::UnitZ()).outlines[0][0].z(), 0);
  EXPECT_EQ(floor_of({level(0), level(2.7)}, Vector::UnitZ()).outlines[0][0].z(), 0);
  EXPECT_TRUE(floor_of({{Point(0, 0, 0), Point(1, 0, 0), Point(0, 0, 1)}}, Vector::UnitZ()).outlines.empty());
}

TEST(FloorGrid, LeavesHolesOut) {
  // A square of 3 x 3 m with a hole of 1 x 1 m in its middle, joined by a seam.
  Scene scene = empty_scene({grey(0.5)});
  scene =
      with_polygon(std::move(scene), {Point(0, 0, 0), Point(3, 0, 0), Point(3, 3, 0), Point(0, 3, 0), Point(0, 0, 0),
                                      Point(1, 1, 0), Point(1, 2, 0), Point(2, 2, 0), Point(2, 1, 0), Point(1, 1, 0)});
  const Floor floor{{corner_points(scene, 0)}, scene.up};
  EXPECT_EQ(floor_grid(floor, 0, 1, 0).sensors.size(), 8U);
}

}  // namespace
}  // namespace patchlight::sensor_grid_test
