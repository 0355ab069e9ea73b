#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/tables/read_tables.h"
#include "input/text.h"
#include "light/photometry.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Fields of the two kinds of lines in use, from 0 (EnergyPlus, Auxiliary Programs, chapter on weather data). The time
// zone is in hours, east positive; an hour from 1 to 24 is the end of its interval.
namespace location {
enum Field : std::size_t { latitude = 6, longitude, time_zone };
}
namespace data {
enum Field : std::size_t { year, month, day, hour, dew_point = 7, direct_normal = 14, diffuse_horizontal };
}

struct Line {
  std::string where;
  std::vector<std::string> fields;

  double number(std::size_t field, const std::string& what) const {
    const std::string text = field < fields.size() ? fields[field] : "";
    const std::optional<double> value = finite_number(trimmed(text));
    if (!value) {
      throw InputError(where, "found '" + text + "' as field " + std::to_string(field + 1) + ", " + what +
                                  "; expected a number, as in an EnergyPlus weather file");
    }
    return *value;
  }
};

Line split(const TextLine& line, const std::string& file) {
  const std::vector<std::string_view> fields = between_commas(line.text);
  return {at_line(file, line.number), {fields.begin(), fields.end()}};
}

double irradiance(const Line& line, std::size_t field, const std::string& what) {
  const double value = line.number(field, what);
  if (value >= 0 && value < 9999) return value;  // 9999 marks a missing value
  throw InputError(line.where,
                   "the " + what + " of this hour is " + line.fields[field] +
                       "; expected W/m^2 from 0 to 9998\nhint: choose an hour, or a file, where it is known");
}

// Precipitable water in cm from the dew point in degrees Celsius. Perez et al. 1990, eq. 3.
double precipitable_water(double dew_point) { return std::exp(0.07 * dew_point - 0.075); }

double within(const Line& line, std::size_t field, double low, double high, const std::string& what) {
  const double value = line.number(field, what);
  if (value >= low && value <= high) return value;
  throw InputError(line.where,
                   what + " is " + shortest(value) + "; expected " + shortest(low) + " to " + shortest(high));
}

WeatherHour weather_of(const Line& place, const Line& line, const Instant& local_time) {
  WeatherHour weather;
  weather.where = line.where;
  weather.begin = static_cast<int>(local_time.hour);
  weather.place = {within(place, location::latitude, -90, 90, "the latitude in degrees"),
                   within(place, location::longitude, -180, 180, "the longitude in degrees")};
  const double zone = within(place, location::time_zone, -14, 14, "the time zone in hours");
  weather.middle = local_time;
  weather.middle.year = static_cast<int>(within(line, data::year, 1, 9999, "the year"));
  weather.middle.hour = local_time.hour + 0.5 - zone;
  weather.solar.direct_normal = irradiance(line, data::direct_normal, "direct normal irradiance");
  weather.solar.diffuse_horizontal = irradiance(line, data::diffuse_horizontal, "diffuse horizontal irradiance");
  weather.solar.day_of_year = day_of_year(weather.middle);
  const double dew_point = within(line, data::dew_point, -100, 100, "the dew point in degrees Celsius");
  if (dew_point < 99.9) weather.solar.precipitable_water = precipitable_water(dew_point);
  return weather;
}

// Days of each month of a year without a leap day.
constexpr std::array<int, 12> days_of_months = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};

bool is_data(const Line& line) {
  return finite_number(trimmed(line.fields[0])).has_value() && line.fields.size() > data::hour;
}

std::string in_words(int month, int day, int hour) {
  return "month " + std::to_string(month) + ", day " + std::to_string(day) + ", hour " + std::to_string(hour);
}

int whole_within(const Line& line, std::size_t field, int low, int high, const std::string& what) {
  const double value = within(line, field, low, high, what);
  if (value == std::floor(value)) return static_cast<int>(value);
  throw InputError(line.where, what + " is " + shortest(value) + "; expected a whole number");
}

// The records of a line DATA PERIODS: one period with one record an hour.
void require_hourly(const Line& line) {
  enum Field : std::size_t { periods = 1, records_per_hour };
  if (line.number(periods, "the number of data periods") != 1)
    throw InputError(line.where, "found " + line.fields[periods] + " data periods; expected 1, a whole year");
  if (line.number(records_per_hour, "the number of records per hour") != 1)
    throw InputError(line.where, "found " + line.fields[records_per_hour] +
                                     " records per hour; expected 1: export the file with hourly values");
}

// The sun is 15 degrees an hour: a zone far from the longitude is mostly one with the wrong sign.
void require_zone_of(const Line& place, const Place& at, double zone) {
  const double off = zone - at.longitude / 15;
  if (std::abs(off) <= 4 || std::abs(std::abs(off) - 24) <= 4) return;
  throw InputError(place.where, "found the time zone " + shortest(zone) + " h and the longitude " +
                                    shortest(at.longitude) + " degrees, which are " +
                                    shortest(std::round(10 * std::abs(off)) / 10) +
                                    " h apart; expected both east positive");
}

// Counts the hours of a year in their order.
struct Calendar {
  int month = 1, day = 1, hour = 0;

  void next() {
    if (++hour < 24) return;
    hour = 0;
    if (++day <= days_of_months[static_cast<std::size_t>(month - 1)]) return;
    day = 1;
    ++month;
  }
};

// Sunlight of an hour in whose middle the sun is below the horizon is not simulated.
struct BelowHorizon {
  std::size_t hours = 0;
  double watt_hours = 0;
};

Diagnostics notes_on(const WeatherYear& year, const BelowHorizon& below, std::size_t leap_hours) {
  Diagnostics notes;
  if (leap_hours > 0)
    notes.push_back({DiagnosticCode::simplified_light,
                     year.file + ": the leap day is left out, so that the year has 8760 hours", leap_hours});
  if (below.hours > 0)
    notes.push_back(
        {DiagnosticCode::sun_below_horizon,
         year.file + ": in " + std::to_string(below.hours) +
             " hours the file states direct sunlight, but the sun is below the horizon in their middle; its " +
             shortest(std::round(below.watt_hours)) + " Wh/m^2 are left out",
         below.hours});
  return notes;
}

}  // namespace

WeatherHour parse_epw(const std::string& text, const std::string& file, const Instant& local_time) {
  Line place;
  for (const TextLine& text_line : logical_lines(text)) {
    const Line line = split(text_line, file);
    if (line.fields[0] == "LOCATION") place = line;
    if (!is_data(line)) continue;
    if (place.fields.empty()) {
      throw InputError(line.where, "found weather before a line LOCATION; expected an EnergyPlus weather file");
    }
    if (line.number(data::month, "the month") != local_time.month) continue;
    if (line.number(data::day, "the day") != local_time.day) continue;
    if (line.number(data::hour, "the hour") != local_time.hour + 1) continue;
    return weather_of(place, line, local_time);
  }
  throw InputError(file, "found no weather for " +
                             in_words(local_time.month, local_time.day, static_cast<int>(local_time.hour)) +
                             "; expected an hour from 0 to 23 of a day that the file has");
}

WeatherHour read_epw(const std::filesystem::path& file, int month, int day, int hour) {
  return parse_epw(read_text(file, file.string(), "weather file"), file.string(),
                   {2000, month, day, static_cast<double>(hour)});
}

Daylight daylight_of(const WeatherHour& weather, const Vector& up, const Vector& north, Eigen::Index bands) {
  const Vector sun = direction_to(solar_position(weather.place, weather.middle), up, north);
  return measured_daylight(weather.solar, sun, up, bands);
}

WeatherYear parse_epw_year(const std::string& text, const std::string& file) {
  WeatherYear year;
  year.file = file;
  Line place;
  Calendar expected;
  BelowHorizon below;
  std::size_t leap_hours = 0;
  for (const TextLine& text_line : logical_lines(text)) {
    const Line line = split(text_line, file);
    if (line.fields[0] == "LOCATION") place = line;
    if (line.fields[0] == "DATA PERIODS") require_hourly(line);
    if (!is_data(line)) continue;
    if (place.fields.empty())
      throw InputError(line.where, "found weather before a line LOCATION; expected an EnergyPlus weather file");
    const int month = whole_within(line, data::month, 1, 12, "the month");
    const int day = whole_within(line, data::day, 1, 31, "the day");
    const int hour = whole_within(line, data::hour, 1, 24, "the hour") - 1;
    if (month == 2 && day == 29) {
      ++leap_hours;
      continue;
    }
    if (expected.month > 12 || month != expected.month || day != expected.day || hour != expected.hour)
      throw InputError(line.where,
                       "found " + in_words(month, day, hour + 1) + "; expected " +
                           (expected.month > 12 ? "the end of the year"
                                                : in_words(expected.month, expected.day, expected.hour + 1)) +
                           ": a year has all 8760 hours in order");
    const Instant local{2000, month, day, static_cast<double>(hour)};
    year.hours.push_back(weather_of(place, line, local));
    const WeatherHour& weather = year.hours.back();
    const bool is_down = solar_position(weather.place, weather.middle).altitude <= 0;
    if (is_down && weather.solar.direct_normal > 0) {
      ++below.hours;
      below.watt_hours += weather.solar.direct_normal;
    }
    expected.next();
  }
  if (year.hours.empty()) throw InputError(file, "found no weather; expected an EnergyPlus weather file (EPW)");
  if (expected.month <= 12)
    throw InputError(file, "ends before " + in_words(expected.month, expected.day, expected.hour + 1) +
                               "; expected all 8760 hours of a year, and found " + std::to_string(year.hours.size()));
  year.place = year.hours.front().place;
  year.time_zone = place.number(location::time_zone, "the time zone");
  require_zone_of(place, year.place, year.time_zone);
  year.notes = notes_on(year, below, leap_hours);
  return year;
}

WeatherYear read_epw_year(const std::filesystem::path& file) {
  return parse_epw_year(read_text(file, file.string(), "weather file"), file.string());
}

Year daylight_of(const WeatherYear& weather, const Scene& scene, double ground_reflectance) {
  // Measured daylight is white in linear RGB.
  const Bands bands = bands_of(scene);
  const Spectrum white = are_of_wavelengths(bands) ? light_in_bands(bands, Spectrum::Ones(3), nullptr)
                                                   : Spectrum(Spectrum::Ones(number_of_bands(scene)));
  const auto in_bands = [&](Spectrum& light) { light = light.mean() * white; };
  Year year;
  year.ground_reflectance = ground_reflectance;
  for (const WeatherHour& hour : weather.hours) {
    Daylight light = daylight_of(hour, scene.up, scene.north, 3);
    if (light.sun) in_bands(light.sun->normal_irradiance);
    if (light.sky) in_bands(light.sky->horizontal_irradiance);
    year.hours.push_back(above_ground(std::move(light), ground_reflectance, scene.up, number_of_bands(scene)));
  }
  return year;
}

}  // namespace patchlight
