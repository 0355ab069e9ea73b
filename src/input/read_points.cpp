#include "patchlight/input/read_points.h"

#include "patchlight/base/error.h"

#include "input/text.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

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
std::string plain(std::string line) {
  line.resize(std::min(line.find('#'), line.size()));
  std::replace_if(
      line.begin(), line.end(), [](char letter) { return letter == ',' || letter == '\r'; }, ' ');
  return line;
}

}  // namespace

SensorGroup read_points(const std::filesystem::path& file, double metres_per_unit) {
  if (is_directory(file)) throw InputError(file.string(), "this is a folder; expected a file of points");
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string(), "cannot be opened; expected a file of points");

  SensorGroup group;
  group.name = file.stem().string();
  group.file = file.string();
  std::string line;
  for (std::uint32_t number = 1; std::getline(stream, line); ++number) {
    line = plain(std::move(line));
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
  if (stream.bad()) throw InputError(file.string(), "reading failed before the end of the file");
  if (group.sensors.empty()) throw InputError(file.string(), "found no points; expected lines x y z nx ny nz");
  return group;
}

}  // namespace patchlight
