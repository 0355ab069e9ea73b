#include "light/solar_position.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::solar_position_test {
namespace {

TEST(SolarPosition, OfThePublishedExampleOfTheMostPreciseAlgorithm) {
  // Reda and Andreas, Solar Position Algorithm for Solar Radiation Applications, NREL/TP-560-34302 (2008), appendix
  // A.5: 17 October 2003, 12:30:30 at UTC - 7 h, 39.742476 N, 105.1786 W. Topocentric elevation without refraction
  // 39.872046 degrees, azimuth 194.340241. The algorithm here guarantees 0.01, and neglects 0.002 of parallax.
  const SolarPosition sun = solar_position({39.742476, -105.1786}, {2003, 10, 17, 12 + 30.5 / 60 + 7});
  EXPECT_NEAR(sun.altitude, 39.872046, 0.012);
  EXPECT_NEAR(sun.azimuth, 194.340241, 0.012);
}

TEST(SolarPosition, AtThePoleIsAsHighAsItsDeclination) {
  // Meeus 1998, example 25.a: 13 October 1992, 0 h: declination -7 deg 47' 06'' = -7.78507 degrees. Dynamical time is
  // 59 s ahead of UTC, during which the declination changes by 0.0003.
  EXPECT_NEAR(solar_position({90, 0}, {1992, 10, 13, 0}).altitude, -7.78507, 0.001);
}

TEST(SolarPosition, IsTheSameOnAMeridianLaterByTheTimeTheEarthTakes) {
  // 15 degrees are one hour, apart from two drifts. The equation of time changes by less than 30 s a day = 0.006
  // degrees an hour. The declination changes by less than 0.4 degrees a day = 0.017 an hour.
  const SolarPosition here = solar_position({50, 15}, {2024, 3, 20, 9});
  const SolarPosition there = solar_position({50, 0}, {2024, 3, 20, 10});
  EXPECT_NEAR(here.altitude, there.altitude, 0.02);
  EXPECT_NEAR(here.azimuth, there.azimuth, 0.02);
}

TEST(SolarPosition, GoesOnAcrossMidnightAndTheYearsEnd) {
  const SolarPosition a = solar_position({10, 20}, {2023, 12, 31, 24});
  const SolarPosition b = solar_position({10, 20}, {2024, 1, 1, 0});
  EXPECT_NEAR(a.altitude, b.altitude, 1e-6);
  EXPECT_NEAR(a.azimuth, b.azimuth, 1e-6);
}

TEST(DirectionTo, NorthEastAndUpAreThoseOfTheScene) {
  EXPECT_NEAR((direction_to({0, 0}, Vector::UnitZ(), Vector::UnitY()) - Vector::UnitY()).norm(), 0, 1e-15);
  EXPECT_NEAR((direction_to({0, 90}, Vector::UnitZ(), Vector::UnitY()) - Vector::UnitX()).norm(), 0, 1e-15);
  EXPECT_NEAR((direction_to({90, 0}, Vector::UnitY(), -Vector::UnitZ()) - Vector::UnitY()).norm(), 0, 1e-15);
  // With y up and north along -z east is still along x.
  EXPECT_NEAR((direction_to({0, 90}, Vector::UnitY(), -Vector::UnitZ()) - Vector::UnitX()).norm(), 0, 1e-15);
}

TEST(DayOfYear, CountsLeapDays) {
  EXPECT_EQ(day_of_year({2023, 1, 1, 0}), 1);
  EXPECT_EQ(day_of_year({2023, 12, 31, 12}), 365);
  EXPECT_EQ(day_of_year({2024, 12, 31, 12}), 366);
  EXPECT_EQ(day_of_year({2024, 3, 1, 23}), 61);
}

}  // namespace
}  // namespace patchlight::solar_position_test
