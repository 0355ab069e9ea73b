#include "patchlight/base/error.h"

#include "input/tables/read_tables.h"
#include "support/scenes.h"

#include <array>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace patchlight::read_epw_year_test {
namespace {

constexpr std::array<int, 12> days = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};

struct MadeUp {
  std::string place = "LOCATION,Somewhere,-,XXX,TMY,000000,47,8,1.0,400";
  std::string records = "1,1";
  bool leap_day = false;
  double direct = 500;
};

// A year with the same sunlight in all hours. Line 1 is the place, hour k of the year is line k + 3 without a leap day.
std::vector<std::string> lines_of(const MadeUp& made) {
  std::vector<std::string> lines = {made.place, "DATA PERIODS," + made.records + ",Data,Sunday, 1/ 1,12/31"};
  for (int month = 1; month <= 12; ++month)
    for (int day = 1; day <= days[static_cast<std::size_t>(month - 1)] + (made.leap_day && month == 2 ? 1 : 0); ++day)
      for (int hour = 1; hour <= 24; ++hour)
        lines.push_back("2001," + std::to_string(month) + ',' + std::to_string(day) + ',' + std::to_string(hour) +
                        ",60,?9,11,1,50,82000,0,0,300,0," + std::to_string(made.direct) + ",100,0,0");
  return lines;
}

std::string text_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

std::string refusal(const std::vector<std::string>& lines) {
  try {
    parse_epw_year(text_of(lines), "city.epw");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(ReadEpwYear, HasEachHourAsItIsReadAlone) {
  // Half an hour beside the whole hours of UTC.
  const std::string text = text_of(lines_of({.place = "LOCATION,Delhi,-,IND,X,0,28.6,77.2,5.5,216"}));
  const WeatherYear year = parse_epw_year(text, "city.epw");
  ASSERT_EQ(year.hours.size(), 8760U);
  EXPECT_EQ(year.time_zone, 5.5);
  for (const auto& [month, day, hour, place] :
       std::initializer_list<std::array<int, 4>>{{1, 1, 0, 0}, {3, 1, 12, 59 * 24 + 12}, {12, 31, 23, 8759}}) {
    const WeatherHour alone = parse_epw(text, "city.epw", {2000, month, day, static_cast<double>(hour)});
    const WeatherHour& found = year.hours[static_cast<std::size_t>(place)];
    EXPECT_EQ(found.middle.hour, alone.middle.hour);
    EXPECT_EQ(found.solar.day_of_year, alone.solar.day_of_year);
    EXPECT_EQ(solar_position(found.place, found.middle).altitude, solar_position(alone.place, alone.middle).altitude);
  }
}

TEST(ReadEpwYear, SunBelowTheHorizonInTheMiddleOfAnHourGivesNothing) {
  const WeatherYear weather = parse_epw_year(text_of(lines_of({})), "city.epw");
  ASSERT_EQ(weather.notes.size(), 1U);
  EXPECT_EQ(weather.notes[0].code, DiagnosticCode::sun_below_horizon);
  const Scene scene = test::cube_room(0.5, 0);
  const Year year = daylight_of(weather, scene, 0.2);
  std::size_t without_sun = 0;
  for (const Daylight& hour : year.hours) without_sun += hour.sun ? 0 : 1;
  EXPECT_EQ(without_sun, weather.notes[0].count);
  EXPECT_NEAR(static_cast<double>(without_sun), 4380, 40);
}

TEST(ReadEpwYear, PolarNightHasNoSun) {
  const WeatherYear weather =
      parse_epw_year(text_of(lines_of({.place = "LOCATION,Alert,-,CAN,X,0,82.5,-62.3,-5.0,30"})), "city.epw");
  const Year year = daylight_of(weather, test::cube_room(0.5, 0), 0.2);
  for (std::size_t hour = 340 * 24; hour < 350 * 24; ++hour) EXPECT_FALSE(year.hours[hour].sun);  // December
  for (std::size_t hour = 160 * 24; hour < 170 * 24; ++hour) EXPECT_TRUE(year.hours[hour].sun);   // June
}

TEST(ReadEpwYear, LeavesOutTheLeapDay) {
  const WeatherYear year = parse_epw_year(text_of(lines_of({.leap_day = true})), "city.epw");
  EXPECT_EQ(year.hours.size(), 8760U);
  EXPECT_EQ(year.hours[59 * 24].middle.month, 3);
  expect_in(year.notes[0].text, "leap day");
}

TEST(ReadEpwYear, GroundIsLitBySunAndSky) {
  const WeatherYear weather = parse_epw_year(text_of(lines_of({})), "city.epw");
  const Daylight noon = daylight_of(weather, test::cube_room(0.5, 0), 0.3).hours[170 * 24 + 12];
  const double on_ground =
      noon.sky->horizontal_irradiance.mean() + noon.sun->direction.z() * noon.sun->normal_irradiance.mean();
  EXPECT_NEAR(noon.sky->ground_radiance.mean(), 0.3 / 3.14159265 * on_ground, 1e-6 * on_ground);
}

TEST(ReadEpwYear, RefusesMissingAndMisplacedHours) {
  std::vector<std::string> lines = lines_of({});
  lines.erase(lines.begin() + 2 + 30);
  expect_in(refusal(lines), "city.epw:33: found month 1, day 2, hour 8; expected month 1, day 2, hour 7");
  lines = lines_of({});
  lines.pop_back();
  expect_in(refusal(lines), "city.epw: ends before month 12, day 31, hour 24");
  lines = lines_of({});
  lines.push_back(lines.back());
  expect_in(refusal(lines), "city.epw:8763: ");
  EXPECT_NE(refusal({lines[0], lines[1]}), "");
}

TEST(ReadEpwYear, RefusesOtherPeriodsAndRecords) {
  expect_in(refusal(lines_of({.records = "1,4"})), "city.epw:2: found 4 records per hour");
  expect_in(refusal(lines_of({.records = "2,1"})), "city.epw:2: found 2 data periods");
}

TEST(ReadEpwYear, RefusesWrongColumns) {
  std::vector<std::string> lines = lines_of({});
  lines[100] = "2001,1,5,3,60,?9,11,1,50,82000,0,0,300,0,oops,100,0,0";
  expect_in(refusal(lines), "city.epw:");
  lines = lines_of({});
  lines[2] = "2001;1;1;1;60";
  EXPECT_NE(refusal(lines), "");
  expect_in(refusal(lines_of({.direct = 9999})), "city.epw:3: the direct normal irradiance of this hour is 9999");
}

TEST(ReadEpwYear, RefusesAZoneFarFromTheLongitude) {
  expect_in(refusal(lines_of({.place = "LOCATION,Denver,-,USA,X,0,39.7,-105.2,7.0,1600"})),
            "city.epw:1: found the time zone 7");
}

}  // namespace
}  // namespace patchlight::read_epw_year_test
