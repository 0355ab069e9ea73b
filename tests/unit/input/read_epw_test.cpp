#include "patchlight/base/error.h"

#include "input/tables/read_tables.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace patchlight::read_epw_test {
namespace {

// The first line and two hours of a made-up weather file, in the fields of EnergyPlus: year, month, day, hour, minute,
// flags, dry bulb, dew point, humidity, pressure, three of extraterrestrial and infrared radiation, global, direct
// normal, diffuse horizontal.
const std::string weather =
    "LOCATION,Somewhere,-,XXX,TMY,000000,39.742476,-105.1786,-7.0,1830.0\n"
    "DESIGN CONDITIONS,0\n"
    "DATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n"
    "1999,10,17,13,60,?9,11.0,1.0,50,82000,900,1400,300,600,800,120,0,0,0,0\n"
    "1999,10,17,14,60,?9,11.0,99.9,50,82000,900,1400,300,600,9999,120,0,0,0,0\n";

std::string refusal(const Instant& time, const std::string& text = weather) {
  try {
    parse_epw(text, "place.epw", time);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadEpw, HasTheHourThatBeginsThen) {
  // Hour 13 of the file is 12:00 to 13:00, whose middle is 19:30 UTC.
  const WeatherHour hour = parse_epw(weather, "place.epw", {2000, 10, 17, 12});
  EXPECT_EQ(hour.solar.direct_normal, 800);
  EXPECT_EQ(hour.solar.diffuse_horizontal, 120);
  EXPECT_EQ(hour.solar.day_of_year, 290);
  EXPECT_NEAR(hour.solar.precipitable_water, std::exp(0.07 * 1 - 0.075), 1e-12);
  EXPECT_NEAR(hour.middle.hour, 19.5, 1e-12);
  EXPECT_EQ(hour.place.latitude, 39.742476);
  EXPECT_EQ(hour.place.longitude, -105.1786);
}

TEST(ReadEpw, SunStandsWhereItDoesInTheMiddleOfTheHour) {
  // The published example of solar_position_test.cpp, half a minute later and in 1999 instead of 2003. Leap days make a
  // difference of less than 0.02 degrees.
  const Daylight day =
      daylight_of(parse_epw(weather, "place.epw", {2000, 10, 17, 12}), Vector::UnitZ(), Vector::UnitY(), 1);
  ASSERT_TRUE(day.sun && day.sky);
  EXPECT_NEAR(std::asin(day.sun->direction.z()) * 57.29578, 39.87, 0.15);
  EXPECT_LT(day.sun->direction.y(), 0);  // in the south
  EXPECT_EQ(day.sky->kind, SkyKind::perez);
}

TEST(ReadEpw, RefusesWithFileAndLine) {
  EXPECT_NE(refusal({2000, 10, 17, 13}).find("place.epw:5: "), std::string::npos);
  EXPECT_NE(refusal({2000, 6, 1, 12}).find("month 6, day 1, hour 12"), std::string::npos);
  EXPECT_NE(refusal({2000, 10, 17, 12}, weather.substr(weather.find("1999"))).find("place.epw:1: "), std::string::npos);
  std::string spoilt = weather;
  spoilt.replace(spoilt.find(",800,"), 5, ",high,");
  EXPECT_NE(refusal({2000, 10, 17, 12}, spoilt).find("place.epw:4: found 'high' "), std::string::npos);
}

}  // namespace
}  // namespace patchlight::read_epw_test
