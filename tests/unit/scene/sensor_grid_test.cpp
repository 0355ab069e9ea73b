#include "scene/sensor_grid.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::sensor_grid_test {
namespace {

using namespace test;

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

// An L of 4 x 4 m without a quarter, in two polygons, rotated by 30 degrees: no cell of 0.5 m is cut.
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
  const SensorGroup grid = floor_grid(floor, 0.8, {0.5, 0});
  EXPECT_EQ(grid.sensors.size(), 48U);
  for (const Sensor& sensor : grid.sensors) {
    EXPECT_NEAR(sensor.point.z(), 1.8, 1e-14);
    const Point back = turn.inverse() * sensor.point;
    EXPECT_FALSE(back.x() > 2 && back.y() > 2);
  }
}

// 40 x 28 m in two triangles, rotated by 30 degrees: rows are parallel to its edges, not to the longer diagonal.
TEST(FloorGrid, StandsParallelToTheRimOfATriangulatedFloor) {
  const Eigen::Affine3d turn(Eigen::AngleAxisd(std::numbers::pi / 6, Vector::UnitZ()));
  std::vector<std::vector<Point>> faces = {{Point(0, 0, 0), Point(40, 0, 0), Point(40, 28, 0)},
                                           {Point(0, 0, 0), Point(40, 28, 0), Point(0, 28, 0)}};
  for (std::vector<Point>& face : faces)
    for (Point& corner : face) corner = turn * corner;
  const Floor floor = floor_of(faces, Vector::UnitZ());
  EXPECT_EQ(floor_grid(floor, 0, {2, 0}).sensors.size(), 20U * 14);
  const Vector along = (turn.inverse().linear() * rectangle_over(floor, 0)[1]).normalized();
  EXPECT_NEAR(std::max(std::abs(along.x()), std::abs(along.y())), 1, 1e-12);
}

// Middles lie at 0.25, 0.75, ... from the walls of 4 x 3 m: 6 x 4 remain at 0.5 m from them.
TEST(FloorGrid, KeepsADistanceFromWalls) {
  const Floor floor{{{Point(0, 0, 0), Point(4, 0, 0), Point(4, 3, 0), Point(0, 3, 0)}}, Vector::UnitZ()};
  EXPECT_EQ(floor_grid(floor, 0.8, {0.5, 0.5}).sensors.size(), 6U * 4);
  EXPECT_TRUE(floor_grid(floor, 0.8, {0.5, 1.6}).sensors.empty());
}

// The floor is the top of a slab, not its underside. The ceiling of a room is not the top of its floor.
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
  EXPECT_EQ(floor_grid(floor, 0, {1, 0}).sensors.size(), 8U);
}

// p = 0.2 * 5^log10(d): 0.2 m for 1 m, five times that for each factor of ten, 10 m at most.
TEST(StandardSpacing, GrowsFivefoldPerFactorOfTen) {
  EXPECT_NEAR(standard_spacing(1, 1), 0.2, 1e-15);
  EXPECT_NEAR(standard_spacing(10, 8), 1, 1e-15);
  EXPECT_NEAR(standard_spacing(100, 80), 5, 1e-14);
  EXPECT_EQ(standard_spacing(1000, 800), 10);
}

TEST(StandardSpacing, IsThatOfTheLongerSideUnlessThisIsTwiceTheOther) {
  EXPECT_EQ(standard_spacing(5, 8), standard_spacing(8, 8));
  EXPECT_EQ(standard_spacing(8, 5), standard_spacing(8, 8));
  EXPECT_EQ(standard_spacing(5, 10), standard_spacing(5, 5));
}

Floor rectangle(double x, double y) {
  return {{{Point(0, 0, 0), Point(x, 0, 0), Point(x, y, 0), Point(0, y, 0)}}, Vector::UnitZ()};
}

// p = 0.855 m: 4 x 7 m without the strip have 5 x 9 cells.
TEST(StandardGrid, CoversARoomOfFiveByEightMetresButForAStrip) {
  const Floor floor = rectangle(5, 8);
  const GridSize size = standard_grid(floor);
  EXPECT_EQ(size.from_walls, 0.5);
  EXPECT_NEAR(size.spacing, 0.2 * std::pow(5, std::log10(8)), 1e-15);
  const SensorGroup grid = floor_grid(floor, 0.8, size);
  EXPECT_EQ(grid.sensors.size(), 5U * 9);
  EXPECT_EQ(most_cells(floor, size), 5 * 9);
  EXPECT_NEAR(area_of(grid), 4 * 7, 1e-12);
}

// The strip takes a quarter of a narrow floor on each side.
TEST(StandardGrid, LeavesPlacesInNarrowRooms) {
  const Floor floor = rectangle(0.8, 3);
  EXPECT_NEAR(standard_grid(floor).from_walls, 0.2, 1e-12);
  EXPECT_NEAR(area_of(floor_grid(floor, 0.8, standard_grid(floor))), 0.4 * 2.6, 1e-12);
}

// Arms of 12 m, 1.5 m wide: p of 12 m is 1.1 m. The strips of 0.375 m leave a row of 0.75 m. Both are smaller by half
// the spacing of the 51 test positions in each direction, 0.12 m.
TEST(StandardGrid, HasARowInACorridorAroundACorner) {
  const Floor floor{
      {{Point(0, 0, 0), Point(12, 0, 0), Point(12, 1.5, 0), Point(1.5, 1.5, 0), Point(1.5, 12, 0), Point(0, 12, 0)}},
      Vector::UnitZ()};
  const SensorGroup grid = floor_grid(floor, 0.8, standard_grid(floor));
  EXPECT_NEAR(area_of(grid), 0.75 * (11.25 + 10.5), 0.12 * 21.75);
}

// An L of 8 x 8 m without a quarter has 7 x 7 - 4 x 4 m^2 without the strip. Cells extend up to half of one beyond its
// inner corner of 4 + 4 m.
TEST(StandardGrid, CoversAnL) {
  const Floor floor{{{Point(0, 0, 0), Point(8, 0, 0), Point(8, 4, 0), Point(4, 4, 0), Point(4, 8, 0), Point(0, 8, 0)}},
                    Vector::UnitZ()};
  const GridSize size = standard_grid(floor);
  EXPECT_NEAR(area_of(floor_grid(floor, 0.8, size)), 49 - 16, size.spacing / 2 * 8);
}

// A room of 4 x 3 m with a pit of 1 x 1 m, 0.5 m deep.
TEST(FloorOfRoom, IsTheLargestLevelUnderItsAir) {
  const auto wall = [](const Point& a, const Point& b, double low, double high) {
    return std::vector<Point>{{a.x(), a.y(), low}, {b.x(), b.y(), low}, {b.x(), b.y(), high}, {a.x(), a.y(), high}};
  };
  const std::vector<Point> outer = {Point(0, 0, 0), Point(4, 0, 0), Point(4, 3, 0), Point(0, 3, 0)};
  const std::vector<Point> pit = {Point(1, 1, 0), Point(1, 2, 0), Point(2, 2, 0), Point(2, 1, 0)};
  std::vector<std::vector<Point>> faces = {
      {outer[0], outer[1], outer[2], outer[3], outer[0], pit[0], pit[1], pit[2], pit[3], pit[0]}, pit, outer};
  for (Point& corner : faces[1]) corner.z() = -0.5;
  for (Point& corner : faces[2]) corner.z() = 2.5;
  for (std::size_t k = 0; k < 4; ++k) {
    faces.push_back(wall(outer[k], outer[(k + 1) % 4], 0, 2.5));
    faces.push_back(wall(pit[k], pit[(k + 1) % 4], -0.5, 0));
  }
  const Floor floor = floor_of_room(faces, Vector::UnitZ());
  EXPECT_NEAR(area_of(floor), 11, 1e-12);
  EXPECT_EQ(floor.outlines[0][0].z(), 0);
}

}  // namespace
}  // namespace patchlight::sensor_grid_test
