#include "cli/points_file.h"

#include "patchlight/base/error.h"

#include "cli/parse_value.h"

#include <array>
#include <fstream>

namespace patchlight::cli {
namespace {

std::array<double, 6> six_numbers(const std::string& where, const std::vector<std::string>& words) {
  constexpr const char* expected = "expected six numbers x y z nx ny nz";
  if (words.size() != 6) {
    throw InputError(where, "found " + std::to_string(words.size()) + " values; " + expected);
  }
  std::array<double, 6> numbers{};
  for (std::size_t k = 0; k < 6; ++k) {
    const std::optional<double> value = to_number(words[k]);
    if (!value) throw InputError(where, "found '" + words[k] + "'; " + expected);
    numbers[k] = *value;
  }
  return numbers;
}

}  // namespace

SensorList read_points(const std::filesystem::path& file, double metres_per_unit) {
  if (is_directory(file)) throw InputError(file.string(), "this is a folder; expected a file of points");
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string(), "cannot be opened; expected a file of points");

  SensorList list;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::vector<std::string> words = split(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    const std::string where = file.string() + ":" + std::to_string(number);
    const std::array<double, 6> values = six_numbers(where, words);
    const Vector direction(values[3], values[4], values[5]);
    if (!(direction.stableNorm() > 0)) {
      throw InputError(where, "the direction nx ny nz is zero; expected the direction that the receiver faces");
    }
    list.sensors.push_back({Point(values[0], values[1], values[2]) * metres_per_unit, direction.stableNormalized()});
    std::string columns = words[0];
    for (std::size_t k = 1; k < 6; ++k) columns += "," + words[k];
    list.lines.push_back(columns);
  }
  if (stream.bad()) throw InputError(file.string(), "reading failed before the end of the file");
  if (list.sensors.empty()) throw InputError(file.string(), "found no points; expected lines x y z nx ny nz");
  return list;
}

}  // namespace patchlight::cli
