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

}  // namespace patchlight
