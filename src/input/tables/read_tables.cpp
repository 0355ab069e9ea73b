#include "input/tables/read_tables.h"

#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

std::array<double, 6> six_numbers(const std::string& where, const std::vector<std::string_view>& found) {
  constexpr const char* expected = "expected six numbers x y z nx ny nz";
  if (found.size() != 6) {
    throw InputError(where, "found " + std::to_string(found.size()) + " values; " + expected);
  }
  std::array<double, 6> numbers{};
  for (std::size_t k = 0; k < 6; ++k) {
    const std::optional<double> value = finite_number(found[k]);
    if (!value) throw InputError(where, "found '" + std::string(found[k]) + "'; " + expected);
    numbers[k] = *value;
  }
  return numbers;
}

// The line without its comment, with words separated by single spaces.
std::string plain(std::string_view text, std::string_view separators) {
  std::string line(text.substr(0, text.find('#')));
  std::replace_if(
      line.begin(), line.end(), [&](char letter) { return separators.find(letter) != separators.npos; }, ' ');
  return line;
}

constexpr const char* expected_line = "expected a wavelength in nm and a value, e.g. 550, 0.43";

// Far more lines than any instrument writes.
constexpr std::size_t longest_spectrum = 100'000;

// Appends a value to the spectrum.
SampledSpectrum with_value(SampledSpectrum spectrum, double wavelength, double value, const std::string& where) {
  if (!(wavelength > 0)) throw InputError(where, "found the wavelength " + shortest(wavelength) + "; expected nm");
  if (!spectrum.wavelengths.empty() && wavelength <= spectrum.wavelengths.back()) {
    throw InputError(where, "found the wavelength " + shortest(wavelength) + " nm after " +
                                shortest(spectrum.wavelengths.back()) +
                                " nm; expected increasing wavelengths: sort the lines and remove duplicates");
  }
  if (value < 0) {
    throw InputError(where, "found " + shortest(value) + " at " + shortest(wavelength) +
                                " nm; expected 0 or more: replace negative readings by 0");
  }
  if (spectrum.values.size() >= longest_spectrum)
    throw InputError(where, "found more than " + std::to_string(longest_spectrum) + " values; expected a spectrum");
  spectrum.wavelengths.push_back(wavelength);
  spectrum.values.push_back(value);
  return spectrum;
}

SampledSpectrum of_columns(const std::vector<TextLine>& lines, const std::filesystem::path& file) {
  SampledSpectrum spectrum;
  bool may_be_heading = true;
  for (const TextLine& line : lines) {
    const std::string text = plain(line.text, ",;");
    const std::vector<std::string_view> found = words(text);
    if (found.empty()) continue;
    const auto is_number = [](std::string_view word) { return finite_number(word).has_value(); };
    const bool has_number = std::any_of(found.begin(), found.end(), is_number);
    if (std::exchange(may_be_heading, false) && !has_number) continue;
    const std::optional<double> wavelength = finite_number(found[0]);
    const std::string where = at_line(file, line.number);
    if (found.size() != 2)
      throw InputError(where, "found " + std::to_string(found.size()) + " values; " + expected_line);
    const std::optional<double> value = finite_number(found[1]);
    if (!wavelength || !value)
      throw InputError(where, "found '" + std::string(wavelength ? found[1] : found[0]) + "'; " + expected_line);
    spectrum = with_value(std::move(spectrum), *wavelength, *value, where);
  }
  return spectrum;
}

// The number after a CGATS keyword, e.g. SPECTRAL_NORM "100.0".
std::optional<double> keyword(const std::vector<TextLine>& lines, std::string_view name) {
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> found = words(line.text);
    if (found.size() < 2 || found[0] != name) continue;
    std::string text(found[1]);
    std::erase(text, '"');
    return finite_number(text);
  }
  return std::nullopt;
}

// Index of the first value in a line of data: the first field SPEC_... of the format.
std::size_t first_field(const std::vector<TextLine>& lines) {
  bool is_format = false;
  std::size_t field = 0;
  for (const TextLine& line : lines) {
    for (const std::string_view word : words(line.text)) {
      if (word == "BEGIN_DATA_FORMAT") {
        is_format = true;
      } else if (word == "END_DATA_FORMAT" || (is_format && word.starts_with("SPEC_"))) {
        return field;
      } else if (is_format) {
        ++field;
      }
    }
  }
  return 0;
}

SampledSpectrum of_cgats(const std::vector<TextLine>& lines, const std::filesystem::path& file) {
  const std::optional<double> bands = keyword(lines, "SPECTRAL_BANDS");
  const std::optional<double> begin = keyword(lines, "SPECTRAL_START_NM"), end = keyword(lines, "SPECTRAL_END_NM");
  const double norm = keyword(lines, "SPECTRAL_NORM").value_or(1);
  if (!begin || !end || !(*bands >= 2) || *bands != std::floor(*bands) ||
      *bands > static_cast<double>(longest_spectrum) || !(*begin < *end) || !(norm > 0))
    throw InputError(file.string(),
                     "SPECTRAL_BANDS of 2 or more, SPECTRAL_START_NM below SPECTRAL_END_NM and SPECTRAL_NORM above 0 "
                     "are expected; found others");
  SampledSpectrum spectrum;
  std::size_t skipped = first_field(lines);
  bool is_data = false;
  const double step = (*end - *begin) / (*bands - 1);
  for (const TextLine& line : lines) {
    for (const std::string_view word : words(line.text)) {
      if (!is_data || word == "END_DATA") {
        is_data = word == "BEGIN_DATA";
        continue;
      }
      if (skipped > 0) {
        --skipped;
        continue;
      }
      if (static_cast<double>(spectrum.values.size()) == *bands) return spectrum;
      const std::optional<double> value = finite_number(word);
      if (!value)
        throw InputError(at_line(file, line.number),
                         "found '" + std::string(word) + "'; expected a value of the spectrum");
      const double wavelength = *begin + step * static_cast<double>(spectrum.values.size());
      spectrum = with_value(std::move(spectrum), wavelength, *value / norm, at_line(file, line.number));
    }
  }
  if (static_cast<double>(spectrum.values.size()) < *bands)
    throw InputError(file.string(), "found " + std::to_string(spectrum.values.size()) +
                                        " values between BEGIN_DATA and END_DATA; expected the " + shortest(*bands) +
                                        " of SPECTRAL_BANDS");
  return spectrum;
}

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
  if (dew_point < 99.9) weather.solar.precipitable_water = precipitable_water(dew_point);
  return weather;
}

}  // namespace

SensorGroup parse_points(std::string_view text, const std::filesystem::path& file, double metres_per_unit) {
  SensorGroup group;
  group.name = file.stem().string();
  group.file = file.string();
  for (std::uint32_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string line = plain(text.substr(0, end), ",\r");
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::vector<std::string_view> found = words(line);
    if (found.empty()) continue;
    const std::string where = file.string() + ":" + std::to_string(number);
    const std::array<double, 6> values = six_numbers(where, found);
    const Vector direction(values[3], values[4], values[5]);
    if (!(direction.stableNorm() > 0)) {
      throw InputError(where, "the direction nx ny nz is zero; expected the direction that the receiver faces");
    }
    group.sensors.push_back({Point(values[0], values[1], values[2]) * metres_per_unit, direction.stableNormalized()});
    group.lines.push_back(number);
    std::string columns(found[0]);
    for (std::size_t k = 1; k < 6; ++k) columns.append(",").append(found[k]);
    group.columns.push_back(columns);
  }
  if (group.sensors.empty()) throw InputError(file.string(), "found no points; expected lines x y z nx ny nz");
  return group;
}

SensorGroup read_points(const std::filesystem::path& file, double metres_per_unit) {
  return parse_points(read_text_or_pipe(file, "the file of points"), file, metres_per_unit);
}

SampledSpectrum parse_spectrum(std::string_view text, const std::filesystem::path& file) {
  const std::vector<TextLine> lines = logical_lines(text);
  SampledSpectrum spectrum = keyword(lines, "SPECTRAL_BANDS") ? of_cgats(lines, file) : of_columns(lines, file);
  if (spectrum.values.empty()) throw InputError(file.string(), std::string("found no spectrum; ") + expected_line);
  spectrum.name = file.filename().string();
  return spectrum;
}

SampledSpectrum read_spectrum(const std::filesystem::path& file) {
  return parse_spectrum(read_text(file, file.string(), "the spectrum"), file);
}

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
