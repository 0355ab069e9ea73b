#include "patchlight/base/error.h"

#include "output/plot/write_sensor_map.h"
#include "scene/sensor_grid.h"
#include "temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <regex>
#include <string>
#include <vector>

namespace patchlight::sensor_map_test {
namespace {

TEST(Isoline, OfALinearFieldIsStraight) {
  Eigen::MatrixXd values(5, 6);
  for (int row = 0; row < 5; ++row)
    for (int column = 0; column < 6; ++column) values(row, column) = 2 * column + row;
  const auto pieces = isoline(values, 5.5);
  double length = 0;
  for (const auto& [from, to] : pieces) {
    EXPECT_NEAR(2 * from[0] + from[1], 5.5, 1e-12);
    EXPECT_NEAR(2 * to[0] + to[1], 5.5, 1e-12);
    length += (to - from).norm();
  }
  // From row 0 to row 4: 4 rows up, 2 columns to the left.
  EXPECT_NEAR(length, std::hypot(4, 2), 1e-12);
}

TEST(Isoline, StopsAtPointsWithoutANumber) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(4, 4);
  values.rightCols(2).setOnes();
  EXPECT_EQ(isoline(values, 0.5).size(), 3U);
  values(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(isoline(values, 0.5).size(), 3U);
  values(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(isoline(values, 0.5).size(), 2U);
}

TEST(Isoline, OfASaddleDoesNotCrossItself) {
  Eigen::MatrixXd values(2, 2);
  values << 1, 0, 0, 1;
  for (const double level : {0.4, 0.6}) {
    const auto pieces = isoline(values, level);
    ASSERT_EQ(pieces.size(), 2U);
    // Below the middle the two high corners are connected: lines cut off the other two. Above it, lines cut off the
    // high ones.
    for (const auto& [from, to] : pieces) {
      const Eigen::Vector2d middle = (from + to) / 2;
      const bool is_near_high = (middle[0] < 0.5) == (middle[1] < 0.5);
      EXPECT_EQ(is_near_high, level > 0.5);
    }
  }
}

struct Grid {
  std::vector<SensorGroup> groups;
  Readings readings;
};

// A grid of 0.5 m over 3 x 2 m, brighter to the east, its axes east and north.
Grid grid(const Vector& east, const Vector& north) {
  SensorGroup group{.name = "desk", .sensors = {}};
  const Vector up = east.cross(north);
  std::vector<double> values;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 6; ++column) {
      const Point low = 0.5 * column * east + 0.5 * row * north + up;
      group.sensors.push_back({low + 0.25 * (east + north), up});
      group.cells.push_back({low, low + 0.5 * east, low + 0.5 * (east + north), low + 0.5 * north});
      values.push_back(100 + 100 * column);
    }
  }
  Field irradiance(static_cast<Eigen::Index>(values.size()), 1);
  for (std::size_t k = 0; k < values.size(); ++k) irradiance(static_cast<Eigen::Index>(k), 0) = values[k];
  return {{group},
          {.irradiance = irradiance, .standard_error = Field::Zero(irradiance.rows(), 1), .bands = usual_bands(1)}};
}

double attribute(const std::string& svg, const std::string& name) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(svg, found, std::regex(name + "=\"([0-9.]+)")));
  return std::stod(found[1]);
}

TEST(SensorMap, IsTheSameWhicheverAxisIsUp) {
  const TemporaryFolder folder;
  const Grid z_up = grid(Vector::UnitX(), Vector::UnitY());
  write_sensor_map(folder.path() / "z.svg", z_up.groups, z_up.readings);
  // y up, with -z for north, as glTF and many models have it
  const Grid y_up = grid(Vector::UnitX(), -Vector::UnitZ());
  write_sensor_map(folder.path() / "y.svg", y_up.groups, y_up.readings,
                   {.up = Vector::UnitY(), .north = -Vector::UnitZ()});
  const std::string svg = content_of(folder.path() / "z.svg");
  EXPECT_EQ(svg, content_of(folder.path() / "y.svg"));
  EXPECT_LT(attribute(svg, "width"), 1500);
  EXPECT_LT(attribute(svg, "height"), 1500);
}

TEST(SensorMap, TakesARangeAndRefusesWhatHasNoMap) {
  const TemporaryFolder folder;
  const Grid some = grid(Vector::UnitX(), Vector::UnitY());
  write_sensor_map(folder.path() / "a.svg", some.groups, some.readings, {.range = {{0, 700}}});
  write_sensor_map(folder.path() / "b.svg", some.groups, some.readings, {.range = {{0, 1400}}});
  EXPECT_NE(content_of(folder.path() / "a.svg"), content_of(folder.path() / "b.svg"));
  EXPECT_THROW(
      write_sensor_map(folder.path() / "c.svg", some.groups, some.readings, {.quantity = MapQuantity::daylight_factor}),
      OutputError);
  std::vector<SensorGroup> points = some.groups;
  points[0].cells.clear();
  // Squares around sensors in a lattice are their cells.
  write_sensor_map(folder.path() / "cells.svg", some.groups, some.readings);
  write_sensor_map(folder.path() / "squares.svg", points, some.readings);
  EXPECT_EQ(content_of(folder.path() / "cells.svg"), content_of(folder.path() / "squares.svg"));
  points[0].sensors.resize(3);
  EXPECT_THROW(write_sensor_map(folder.path() / "c.svg", points, some.readings), OutputError);
}

// Scale, north and walls are in the file if they are known. Distant walls are not. Length of the first line of this
// kind to the right: from the first group's position to the last one's.
double length_of(const std::string& svg, const std::string& kind) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(svg, found, std::regex(kind)));
  return std::stod(found[found.size() - 1]) - std::stod(found[1]);
}

TEST(SensorMap, ShowsTheWallsAroundAGridAndItsScale) {
  const TemporaryFolder folder;
  const Grid some = grid(Vector::UnitX(), Vector::UnitY());
  const auto drawn = [&](const MapOptions& options) {
    write_sensor_map(folder.path() / "map.svg", some.groups, some.readings, options);
    return content_of(folder.path() / "map.svg");
  };
  const std::string plain = drawn({});
  EXPECT_NE(drawn({.north_known = true}), plain);
  const std::array<Point, 2> wall = {Point(0, -0.2, 1), Point(3, -0.2, 1)};
  const std::array<Point, 2> far_off = {Point(0, -90, 1), Point(3, -90, 1)};
  const std::string walls = drawn({.sections = {{wall}}});
  EXPECT_EQ(drawn({.sections = {{wall, far_off}}}), walls);
  EXPECT_NE(drawn({.sections = {{far_off}}}), walls);
  // The bar is a round fraction of the wall's 3 m: 0.5 m.
  const double of_wall = length_of(walls, R"-(d="M ([\d.]+) ([\d.]+) L (?=[\d.]+ \2 "/)([\d.]+))-");
  const double of_bar = length_of(walls, R"-(M ([\d.]+) [\d.]+ L \1 [\d.]+ M \1 ([\d.]+) L (?=[\d.]+ \2 M)([\d.]+))-");
  EXPECT_NEAR(3 * of_bar / of_wall, 0.5, 1e-3);
}

}  // namespace
}  // namespace patchlight::sensor_map_test
