#include "input/tables/read_points.h"

#include "patchlight/base/error.h"

#include "input/text.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

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

// The line without its comment, and with nothing but spaces between its words.
std::string plain(std::string_view text) {
  std::string line(text.substr(0, text.find('#')));
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return letter == ',' || letter == '\r'; }, ' ');
  return line;
}

}  // namespace

SensorGroup parse_points(std::string_view text, const std::filesystem::path& file, double metres_per_unit) {
  SensorGroup group;
  group.name = file.stem().string();
  group.file = file.string();
  for (std::uint32_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string line = plain(text.substr(0, end));
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

}  // namespace patchlight
