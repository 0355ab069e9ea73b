#include "patchlight/annual/metrics.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace patchlight::metrics_test {
namespace {

// Ten hours, all occupied; the first six are in daylight.
CountedHours ten_hours() {
  CountedHours hours{std::vector<std::uint8_t>(10, 1), std::vector<std::uint8_t>(10, 0)};
  for (std::size_t k = 0; k < 6; ++k) hours.daylight[k] = 1;
  return hours;
}

// A sensor for each list of illuminances; no sun, no errors, a daylight factor of 2 %.
AnnualLight light_of(const std::vector<std::vector<float>>& sensors) {
  AnnualLight light;
  const auto count = static_cast<Eigen::Index>(sensors.size());
  const auto hours = static_cast<Eigen::Index>(sensors.front().size());
  light.illuminance.resize(hours, count);
  light.sunlight = HourlyValues::Zero(hours, count);
  light.daylight_factor = light.solved_daylight_factor = Eigen::VectorXd::Constant(count, 2);
  light.relative_error = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index k = 0; k < hours; ++k)
      light.illuminance(k, i) = sensors[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  return light;
}

std::vector<SensorGroup> group_of(std::size_t sensors) {
  return {{"room", std::vector<Sensor>(sensors, {Point::Zero(), Vector::UnitZ()})}};
}

const std::vector<float> series = {0, 50, 100, 150, 299, 300, 1000, 3000, 3001, 9000};

double of(const std::array<Measure, sensor_measures>& measures, SensorMeasure m) {
  return measures[static_cast<std::size_t>(m)].value;
}
double of(const RoomYear& room, RoomMeasure m) { return room.measures[static_cast<std::size_t>(m)].value; }

TEST(Metrics, OfASensorFollowTheirDefinitions) {
  const AnnualMetrics found = metrics_of(light_of({series}), group_of(1), ten_hours());
  const auto& sensor = found.sensors[0];
  EXPECT_NEAR(of(sensor, SensorMeasure::mean_illuminance), 1690, 1e-9);
  EXPECT_NEAR(of(sensor, SensorMeasure::autonomy), 50, 1e-9);  // 300 and more
  // 0, 1/6, 1/3, 1/2, 299/300, and five whole hours.
  EXPECT_NEAR(of(sensor, SensorMeasure::continuous), 10 * (1 + 299.0 / 300 + 5), 1e-9);
  EXPECT_NEAR(of(sensor, SensorMeasure::udi_below_100), 20, 1e-9);
  EXPECT_NEAR(of(sensor, SensorMeasure::udi_100_to_300), 30, 1e-9);
  EXPECT_NEAR(of(sensor, SensorMeasure::udi_300_to_3000), 30, 1e-9);
  EXPECT_NEAR(of(sensor, SensorMeasure::udi_above_3000), 20, 1e-9);
  // Three of six daylight hours have 150 lx or more.
  EXPECT_NEAR(of(sensor, SensorMeasure::half_of_daylight), 150, 1e-4);
}

TEST(Metrics, CountOnlyOccupiedHours) {
  CountedHours hours = ten_hours();
  hours.occupied = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1};
  const AnnualMetrics found = metrics_of(light_of({series}), group_of(1), hours);
  EXPECT_NEAR(of(found.sensors[0], SensorMeasure::autonomy), 100, 1e-9);
  EXPECT_EQ(found.occupied_hours, 5U);
}

// IES LM-83-12: sDA counts sensors with 300 lx in half of the hours.
TEST(Metrics, SpatialAutonomyIsTheShareOfSensorsWithHalfOfTheHours) {
  std::vector<float> dim = series;
  dim[5] = 299;
  const AnnualMetrics found = metrics_of(light_of({series, dim, series, dim}), group_of(4), ten_hours());
  EXPECT_NEAR(of(found.rooms[0], RoomMeasure::spatial_autonomy), 50, 1e-9);
  EXPECT_NEAR(of(found.rooms[0], RoomMeasure::mean_autonomy), 45, 1e-9);
  EXPECT_NEAR(of(found.building, RoomMeasure::spatial_autonomy), 50, 1e-9);
}

// IES LM-83-12: more than 250 hours with more than 1000 lx straight from the sun.
TEST(Metrics, SunlightExposureTakesMoreThan250Hours) {
  AnnualLight light = light_of({std::vector<float>(300, 2000), std::vector<float>(300, 2000)});
  light.sunlight.col(0).head(250).setConstant(1001);
  light.sunlight.col(1).head(251).setConstant(1001);
  const CountedHours hours{std::vector<std::uint8_t>(300, 1), std::vector<std::uint8_t>(300, 1)};
  const AnnualMetrics found = metrics_of(light, group_of(2), hours);
  EXPECT_NEAR(of(found.rooms[0], RoomMeasure::sunlight_exposure), 50, 1e-9);
  EXPECT_NEAR(of(found.sensors[0], SensorMeasure::sunlit_hours), 250, 1e-9);
}

// EN 17037:2018, table A.1.
TEST(Metrics, GradesFollowTargetAndMinimum) {
  const auto grade = [](float half, float rest) {
    std::vector<std::vector<float>> sensors;
    for (int k = 0; k < 20; ++k) sensors.emplace_back(10, k < 10 ? half : rest);
    const AnnualMetrics found = metrics_of(light_of(sensors), group_of(20), ten_hours());
    return of(found.rooms[0], RoomMeasure::grade);
  };
  EXPECT_EQ(grade(299, 299), 0);
  EXPECT_EQ(grade(300, 99), 0);
  EXPECT_EQ(grade(300, 100), 1);
  EXPECT_EQ(grade(500, 300), 2);
  EXPECT_EQ(grade(750, 499), 2);
  EXPECT_EQ(grade(750, 500), 3);
}

TEST(Metrics, ErrorsAreThoseOfBrighterAndDarkerLightWithoutTheSun) {
  AnnualLight light = light_of({std::vector<float>(10, 1200)});
  light.sunlight.setConstant(1000);
  light.relative_error.setConstant(0.1);
  const Measure mean = metrics_of(light, group_of(1), ten_hours()).sensors[0][0];
  EXPECT_NEAR(mean.value, 1200, 1e-9);
  EXPECT_NEAR(mean.standard_error, 20, 1e-9);  // a tenth of 200 lx
}

TEST(Metrics, LeaveOutSensorsInsideWalls) {
  AnnualLight light = light_of({series, series});
  light.illuminance.col(1).setConstant(std::numeric_limits<float>::quiet_NaN());
  const AnnualMetrics found = metrics_of(light, group_of(2), ten_hours());
  EXPECT_EQ(found.rooms[0].inside_walls, 1U);
  EXPECT_NEAR(of(found.rooms[0], RoomMeasure::mean_illuminance), 1690, 1e-9);
  EXPECT_TRUE(std::isnan(of(found.sensors[1], SensorMeasure::autonomy)));
}

TEST(Metrics, KeepValuesWhoseErrorIsNotKnown) {
  AnnualLight light = light_of({series});
  light.relative_error[0] = std::numeric_limits<double>::quiet_NaN();
  const AnnualMetrics found = metrics_of(light, group_of(1), ten_hours());
  EXPECT_EQ(found.rooms[0].inside_walls, 0U);
  EXPECT_NEAR(found.sensors[0][0].value, 1690, 1e-9);
  EXPECT_TRUE(std::isnan(found.sensors[0][0].standard_error));
  EXPECT_TRUE(std::isnan(found.rooms[0].measures[0].standard_error));
}

}  // namespace
}  // namespace patchlight::metrics_test
