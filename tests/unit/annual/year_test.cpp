#include "patchlight/annual/annual.h"
#include "patchlight/base/error.h"
#include "patchlight/views/views.h"

#include "light/photometry.h"
#include "light/solar_position.h"
#include "support/daylight_office.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::year_test {
namespace {

constexpr double ground = 0.2;

// An office with sensors near its window, behind the desk, at its back, and on the ceiling.
Scene office_with_sensors() {
  Scene scene = test::daylight_office();
  scene.photometric = true;
  scene.sensors = {{"desk",
                    {{Point(2, 0.7, 0.8), Vector::UnitZ()},
                     {Point(1.2, 2.5, 0.85), Vector::UnitZ()},
                     {Point(3.4, 4.3, 0.8), Vector::UnitZ()},
                     {Point(2, 4.9, 1.5), -Vector::UnitY()},
                     {Point(1, 3.5, 2.9), -Vector::UnitZ()}}}};
  return scene;
}

// Sun and sky for a place of the sun, as with_lights() has them.
Daylight daylight_at(const SolarPosition& sun, double direct, double diffuse, const Scene& scene) {
  const SolarIrradiance measured{direct, diffuse, 100, 2};
  Daylight light = measured_daylight(measured, direction_to(sun, scene.up, scene.north), scene.up, 1);
  if (!light.sky) return light;
  Spectrum on_ground = light.sky->horizontal_irradiance;
  if (light.sun) on_ground += light.sun->direction.dot(scene.up) * light.sun->normal_irradiance;
  light.sky->ground_radiance = ground / std::numbers::pi * on_ground;
  return light;
}

// Twelve hours: clear and overcast, with the sun in the window, beside it, high, low and behind the office.
Year twelve_hours(const Scene& scene) {
  Year year{.hours = {}, .ground_reflectance = ground};
  for (const auto& [altitude, azimuth, direct, diffuse] :
       std::initializer_list<std::array<double, 4>>{{10, 140, 400, 60},
                                                    {20, 160, 600, 80},
                                                    {27, 180, 750, 90},
                                                    {15, 215, 500, 70},
                                                    {40, 120, 700, 100},
                                                    {55, 180, 850, 110},
                                                    {62, 240, 800, 120},
                                                    {35, 265, 300, 200},
                                                    {8, 70, 200, 50},
                                                    {30, 300, 650, 90},
                                                    {45, 200, 0, 300},
                                                    {12, 150, 20, 110}})
    year.hours.push_back(daylight_at({altitude, azimuth}, direct, diffuse, scene));
  return year;
}

Request small_request(Storage storage) {
  Request request;
  request.mesh.patches = 1000;
  request.assembly.storage = storage;
  request.accuracy.cheap_error_bars = true;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  return request;
}

AnnualLight year_of(const Scene& scene, const Year& year, const Request& request) {
  return simulate_year(scene, year, request);
}

// Each sensor reads in each hour what a run for that hour alone has, within a share of it and three standard errors.
void expect_hours_as_solved(Scene scene, const Request& request, const Year& year, double share = 0.01) {
  const AnnualLight light = year_of(scene, year, request);
  scene.luminaires.clear();
  for (std::size_t hour = 0; hour < year.hours.size(); ++hour) {
    scene.sun = year.hours[hour].sun;
    scene.sky = year.hours[hour].sky;
    const Readings readings = read_sensors(simulate(scene, request)).readings;
    for (Eigen::Index i = 0; i < light.illuminance.cols(); ++i) {
      const auto [value, error] = sensor_value(readings, static_cast<std::size_t>(i));
      const double found = light.illuminance(static_cast<Eigen::Index>(hour), i);
      EXPECT_NEAR(found, value, share * value + 3 * error) << "hour " << hour << ", sensor " << i;
    }
  }
}

TEST(Year, HasTheLightOfEachHourByPairs) {
  const Scene scene = office_with_sensors();
  expect_hours_as_solved(scene, small_request(Storage::tiles), twelve_hours(scene));
}

TEST(Year, HasTheLightOfEachHourByRays) {
  const Scene scene = office_with_sensors();
  expect_hours_as_solved(scene, small_request(Storage::rays), twelve_hours(scene));
}

// A wall of the office is a mirror, which throws the sun onto the floor, the other walls and sensors. As these suns
// stand together in divisions of the sky, light that patches reflect may be off by more.
TEST(Year, HasTheLightOfMirrors) {
  Scene scene = office_with_sensors();
  Material mirror = test::named("mirror", 0.1);
  mirror.specular_reflectance = test::watts(0.8);
  scene.materials.push_back(mirror);
  scene.polygons[5].material = static_cast<MaterialIndex>(scene.materials.size() - 1);
  Year year = twelve_hours(scene);
  year.hours.resize(4);
  expect_hours_as_solved(scene, small_request(Storage::rays), year, 0.03);
}

TEST(Year, DivisionsSumUpToTheDaylightFactor) {
  const Scene scene = office_with_sensors();
  const AnnualLight light = year_of(scene, twelve_hours(scene), small_request(Storage::rays));
  for (Eigen::Index i = 0; i < light.daylight_factor.size(); ++i) {
    const double solved = light.solved_daylight_factor[i];
    EXPECT_NEAR(light.daylight_factor[i], solved, (0.005 + 2 * light.relative_error[i]) * solved) << i;
  }
}

// Before nothing but the ground a horizontal sensor reads E_diffuse + E_normal sin h.
TEST(Year, FreeHorizontalSensorReadsTheGlobalIlluminance) {
  Scene scene = test::with_quad(test::empty_scene({test::grey(0.2)}),
                                {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene.photometric = true;
  scene.sensors = {{"free", {{Point(0.5, 0.5, 5), Vector::UnitZ()}}}};
  const Year year = twelve_hours(scene);
  for (const int factor : {1, 2, 4}) {
    const AnnualLight light = simulate_year(scene, year, small_request(Storage::tiles), {.sky_division = factor});
    for (std::size_t hour = 0; hour < year.hours.size(); ++hour) {
      const Daylight& of = year.hours[hour];
      double expected = luminance(of.sky->horizontal_irradiance);
      if (of.sun) expected += of.sun->direction.z() * luminance(of.sun->normal_irradiance);
      EXPECT_NEAR(light.illuminance(static_cast<Eigen::Index>(hour), 0) / expected, 1, 0.01) << factor << ' ' << hour;
    }
  }
}

// The sun of the southern hemisphere stands in the north at noon: a window to the north has sun, one to the south none.
TEST(Year, SunStandsInTheNorthOfTheSouthernHemisphere) {
  Scene scene = office_with_sensors();
  Year year{.hours = {}, .ground_reflectance = ground};
  for (int month = 1; month <= 12; ++month) {
    const SolarPosition noon = solar_position({-35, 0}, {2023, month, 21, 12});
    year.hours.push_back(daylight_at(noon, 700, 100, scene));
  }
  scene.sensors = {{"sill", {{Point(2, 0.3, 1.5), -Vector::UnitY()}}}};  // faces the window
  EXPECT_EQ(year_of(scene, year, small_request(Storage::tiles)).sunlight.maxCoeff(), 0);
  for (Daylight& hour : year.hours) {  // the same for an office turned around
    for (Vector* const to : {&hour.sun->direction, &hour.sky->sun_direction}) *to = Vector(-to->x(), -to->y(), to->z());
  }
  EXPECT_GT(year_of(scene, year, small_request(Storage::tiles)).sunlight.minCoeff(), 0);
}

TEST(Year, SensorsInsideWallsReadNothing) {
  Scene scene = office_with_sensors();
  scene.sensors[0].sensors.push_back({Point(1.5, 2.5, 0.6), Vector::UnitZ()});  // inside the desk
  const AnnualLight light = year_of(scene, twelve_hours(scene), small_request(Storage::tiles));
  EXPECT_TRUE(std::isnan(light.illuminance(0, 5)));
  EXPECT_FALSE(std::isnan(light.illuminance(0, 4)));
}

TEST(Year, RefusesAYearWithoutLight) {
  const Scene scene = office_with_sensors();
  EXPECT_THROW(year_of(scene, Year{std::vector<Daylight>(24), 0.2}, {}), InputError);
}

}  // namespace
}  // namespace patchlight::year_test
