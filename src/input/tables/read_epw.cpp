#include "input/tables/read_epw.h"

#include "patchlight/base/error.h"

#include "base/rounded.h"
#include "input/text.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace patchlight {
namespace {

// Fields of the two kinds of lines that are used, from 0. EnergyPlus, Auxiliary Programs, chapter on weather data.
namespace location {
constexpr std::size_t latitude = 6;
constexpr std::size_t longitude = 7;
constexpr std::size_t time_zone = 8;  // hours, east positive
}  // namespace location
namespace data {
constexpr std::size_t year = 0;
constexpr std::size_t month = 1;
constexpr std::size_t day = 2;
constexpr std::size_t hour = 3;  // 1 to 24, the one that ends then
constexpr std::size_t dew_point = 7;
constexpr std::size_t direct_normal = 14;
constexpr std::size_t diffuse_horizontal = 15;
}  // namespace data

// What stands for a missing value.
constexpr double missing_irradiance = 9999;
constexpr double missing_dew_point = 99.9;

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
  Line split{file + ":" + std::to_string(line.number), {}};
  std::size_t begin = 0;
  while (begin <= line.text.size()) {
    const std::size_t end = std::min(line.text.find(',', begin), line.text.size());
    split.fields.push_back(line.text.substr(begin, end - begin));
    begin = end + 1;
  }
  return split;
}

double irradiance(const Line& line, std::size_t field, const std::string& what) {
  const double value = line.number(field, what);
  if (value >= 0 && value < missing_irradiance) return value;
  throw InputError(line.where, "the " + what + " of this hour is " + line.fields[field] +
                                   "; expected W/m^2 from 0 to 9998. Choose an hour where it is known");
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
  if (dew_point < missing_dew_point) weather.solar.precipitable_water = precipitable_water(dew_point);
  return weather;
}

}  // namespace

WeatherHour parse_epw(const std::string& text, const std::string& file, const Instant& local_time) {
  Line place;
  for (const TextLine& text_line : logical_lines(text)) {
    const Line line = split(text_line, file);
    if (line.fields[0] == "LOCATION") place = line;
    if (!finite_number(trimmed(line.fields[0])) || line.fields.size() <= data::hour) continue;
    if (place.fields.empty()) {
      throw InputError(line.where, "found weather before a line LOCATION; expected an EnergyPlus weather file");
    }
    if (line.number(data::month, "the month") != local_time.month) continue;
    if (line.number(data::day, "the day") != local_time.day) continue;
    if (line.number(data::hour, "the hour") != local_time.hour + 1) continue;
    return weather_of(place, line, local_time);
  }
  throw InputError(file, "found no weather for month " + std::to_string(local_time.month) + ", day " +
                             std::to_string(local_time.day) + ", hour " +
                             std::to_string(static_cast<int>(local_time.hour)) +
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

}  // namespace patchlight
