#include "patchlight/scene/daylight.h"

#include "light/photometry.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::daylight_test {
namespace {

Vector at_altitude(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return {std::cos(a), 0, std::sin(a)};
}

TEST(PerezClass, HasTheLimitsOfTheTable) {
  EXPECT_EQ(perez_class(1), 0U);
  EXPECT_EQ(perez_class(1.064), 0U);
  EXPECT_EQ(perez_class(1.065), 1U);
  EXPECT_EQ(perez_class(2.0), 4U);
  EXPECT_EQ(perez_class(6.2), 7U);
  EXPECT_EQ(perez_class(100), 7U);
}

TEST(MeasuredDaylight, HasPerezsClearnessAndBrightness) {
  // Perez et al. 1990, eqs. 1 and 2, by hand. With the sun at the zenith the air mass is 0.9997, and its term in the
  // clearness is 0. The clearness is (100 + 400) / 100, the brightness 100 / (1367 x 1.0330) on January 1.
  const Daylight day = measured_daylight({400, 100, 1}, Vector::UnitZ(), Vector::UnitZ(), 3);
  ASSERT_TRUE(day.sky && day.sun);
  EXPECT_EQ(day.sky->kind, SkyKind::perez);
  EXPECT_NEAR(day.sky->clearness, 5, 1e-12);
  EXPECT_NEAR(day.sky->brightness, 100 / (1367 * 1.0330), 1e-4);
  // Class 7 with 2 cm of water. Sky: 141.88 + 1.90 x 2 - 53.24 - 14.03 ln 0.07081 lm/W. Sun: 105.75 + 0.77 x 2 - 1.26
  // exp(-5) - 34.44 x 0.07081.
  EXPECT_NEAR(luminance(day.sky->horizontal_irradiance), 100 * (92.44 + 14.03 * 2.6477), 5);
  EXPECT_NEAR(luminance(day.sun->normal_irradiance), 400 * (107.29 - 0.00849 - 2.4387), 5);
}

TEST(MeasuredDaylight, WithoutDirectLightIsOvercast) {
  const Daylight day = measured_daylight({0, 200, 80}, at_altitude(30), Vector::UnitZ(), 1);
  ASSERT_TRUE(day.sky);
  EXPECT_FALSE(day.sun);
  EXPECT_NEAR(day.sky->clearness, 1, 1e-12);
  EXPECT_EQ(perez_class(day.sky->clearness), 0U);
}

TEST(MeasuredDaylight, AfterSunsetHasNoSun) {
  const Daylight dusk = measured_daylight({50, 10, 80}, at_altitude(-2), Vector::UnitZ(), 1);
  EXPECT_FALSE(dusk.sun);
  ASSERT_TRUE(dusk.sky);
  EXPECT_EQ(dusk.sky->kind, SkyKind::uniform);
  EXPECT_GT(dusk.sky->horizontal_irradiance[0], 0);
  const Daylight night = measured_daylight({0, 0, 80}, at_altitude(-30), Vector::UnitZ(), 1);
  EXPECT_FALSE(night.sun || night.sky);
}

}  // namespace
}  // namespace patchlight::daylight_test
