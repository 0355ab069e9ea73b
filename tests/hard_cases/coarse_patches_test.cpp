// Sensors near patches that are coarser than the distance to the sensor. The reflected light must vary smoothly between
// patches, and the error bars must cover the remaining error.
#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

namespace patchlight::coarse_patches_test {
namespace {

using namespace test;

constexpr double reflectance = 0.5;
constexpr double intensity = 100;
constexpr double width = 10;
constexpr double height_of_lamp = 2;
constexpr double height_of_sensors = 0.8;

// A reflecting floor in a black room, with a point lamp over its middle and sensors that face down.
Scene lit_floor() {
  Scene scene = with_box(empty_scene({grey(0), grey(reflectance)}), Point(0, 0, 0), Point(width, width, 3), true);
  for (Polygon& polygon : scene.polygons) {
    double highest = 0;
    for (const std::uint32_t vertex : polygon.corners) highest = std::max(highest, scene.vertices[vertex].z());
    if (highest == 0) polygon.material = 1;
  }
  Luminaire lamp;
  lamp.position = {width / 2, width / 2, height_of_lamp};
  lamp.light = PointLight{Spectrum::Constant(1, intensity)};
  scene.luminaires = {lamp};
  SensorGroup group{.name = "over the floor", .sensors = {}};
  for (double x = 0.7; x < width; x += 1.25) {
    for (double y = 1.1; y < width; y += 2) group.sensors.push_back({{x, y, height_of_sensors}, -Vector::UnitZ()});
  }
  scene.sensors = {group};
  return scene;
}

// The midpoint rule for int rho I h_l / (pi d^3) h_s^2 / r^4 dA over the floor, with 200 x 200 points 5 cm apart. The
// integrand varies over the height of the sensor. 400 x 400 points change the result by less than 1e-4.
double exact(const Sensor& sensor) {
  constexpr int points = 200;
  constexpr double step = width / points;
  double sum = 0;
  for (int i = 0; i < points; ++i) {
    for (int j = 0; j < points; ++j) {
      const double x = (i + 0.5) * step;
      const double y = (j + 0.5) * step;
      const double to_lamp = std::pow(x - width / 2, 2) + std::pow(y - width / 2, 2) + std::pow(height_of_lamp, 2);
      const double to_sensor =
          std::pow(x - sensor.point.x(), 2) + std::pow(y - sensor.point.y(), 2) + std::pow(height_of_sensors, 2);
      sum += height_of_lamp / std::pow(to_lamp, 1.5) / std::pow(to_sensor, 2);
    }
  }
  return reflectance * intensity * std::pow(height_of_sensors, 2) / std::numbers::pi * sum * step * step;
}

struct Found {
  double error = 0;   // root mean square
  double stated = 0;  // likewise
  int beyond = 0;     // by more than two bars
  int sensors = 0;
};

Found with_patches(const Scene& scene, double edge, bool error_bars) {
  Request request;
  request.mesh.max_edge = edge;
  request.accuracy.error_bars = error_bars;
  const SensorView view = read_sensors(simulate(scene, request));
  Found found;
  for (const Sensor& sensor : scene.sensors[0].sensors) {
    const double error = view.readings.irradiance(found.sensors, 0) - exact(sensor);
    const double bar = view.readings.standard_error(found.sensors, 0);
    found.error += error * error;
    found.stated += bar * bar;
    if (std::abs(error) > 2 * bar) ++found.beyond;
    ++found.sensors;
  }
  found.error = std::sqrt(found.error / found.sensors);
  found.stated = std::sqrt(found.stated / found.sensors);
  return found;
}

TEST(CoarsePatches, SensorsSayHowFarTheyAreOff) {
  // The patches are as wide as the lamp is high, half of that, and a quarter. The error bars must not add the
  // contributions of the slopes with their signs: these cancel by chance, and a third of the sensors would exceed two
  // bars.
  const Scene scene = lit_floor();
  for (const bool error_bars : {false, true}) {
    for (const double edge : {2.0, 1.0, 0.5}) {
      SCOPED_TRACE(testing::Message() << "edge " << edge << (error_bars ? ", with" : ", without") << " error bars");
      const Found found = with_patches(scene, edge, error_bars);
      EXPECT_LE(found.beyond, found.sensors / 20);
      EXPECT_GT(found.stated, 0.7 * found.error);
      EXPECT_LT(found.stated, 5 * found.error);
    }
  }
}

TEST(CoarsePatches, SensorsErrAsTheSquareOfTheirSize) {
  // Linear interpolation leaves an error of second order. Constant patches leave one of first order, half at half the
  // size.
  const Scene scene = lit_floor();
  const double coarse = with_patches(scene, 1.0, false).error;
  const double fine = with_patches(scene, 0.5, false).error;
  EXPECT_LT(fine, coarse / 3);
}

TEST(CoarsePatches, OfWhichThereAreOneOrFourSayThatTheyKnowNothing) {
  // One patch, or four equal ones, give no information about the light in the middle of a floor. The hidden error
  // exceeds half of the light; the stated error must lie between half of the light and all of it.
  const Scene scene = lit_floor();
  double exactly = 0;
  for (const Sensor& sensor : scene.sensors[0].sensors) exactly += std::pow(exact(sensor), 2);
  const double light = std::sqrt(exactly / static_cast<double>(scene.sensors[0].sensors.size()));
  for (const bool error_bars : {false, true}) {
    for (const double edge : {20.0, 5.0}) {
      SCOPED_TRACE(testing::Message() << "edge " << edge << (error_bars ? ", with" : ", without") << " error bars");
      const Found found = with_patches(scene, edge, error_bars);
      EXPECT_GT(found.error, 0.5 * light);
      EXPECT_GT(found.stated, 0.5 * light);
      EXPECT_LT(found.stated, light);
      EXPECT_LE(found.beyond, found.sensors / 10);
    }
  }
}

TEST(CoarsePatches, BehindAColouredPaneSendNothingThatThisHolds) {
  // A sensor in a black pipe whose end is a pane that transmits the first band only. The floor is uneven, but none of
  // its light in the second band reaches the sensor.
  Scene scene = lit_floor();
  for (Material& material : scene.materials) {
    material.reflectance = material.reflectance.replicate(1, 2).eval();
    material.exitance = material.exitance.replicate(1, 2).eval();
  }
  std::get<PointLight>(scene.luminaires[0].light).intensity = Spectrum::Constant(2, intensity);
  Material pane{.name = "pane", .reflectance = Spectrum::Zero(2), .exitance = Spectrum::Zero(2)};
  pane.transmittance = Spectrum::Zero(2);
  pane.transmittance[0] = 0.9;
  scene.materials.push_back(pane);
  const Point low(4.1, 4.1, 0.7);
  const Point high(4.3, 4.3, 1.0);
  const std::vector<Quad> faces = box_faces(low, high, true);
  for (const Quad& face : faces) {
    double highest = 0;
    for (const Point& corner : face) highest = std::max(highest, corner.z());
    scene = with_quad(std::move(scene), face, highest == low.z() ? 2 : 0);
  }
  scene.sensors[0].sensors = {{Point(4.2, 4.2, 0.8), -Vector::UnitZ()}};
  Request request;
  request.mesh.max_edge = 1;
  request.mesh.sides = Sides::both;
  const SensorView view = read_sensors(simulate(scene, request));
  EXPECT_GT(view.readings.irradiance(0, 0), 0);
  EXPECT_EQ(view.readings.irradiance(0, 1), 0);
}

}  // namespace
}  // namespace patchlight::coarse_patches_test
