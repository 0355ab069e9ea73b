#include "cli/parse_value.h"

#include "base/words.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <span>

namespace patchlight::cli {
namespace {

// Name and size of a unit.
using Unit = std::pair<const char*, double>;

// A plain number is in meters.
constexpr std::array<Unit, 6> units_of_length = {
    {{"", 1}, {"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};

// A positive number times its unit; empty for an unknown unit.
std::optional<double> quantity(const std::string& text, std::span<const Unit> units) {
  const std::size_t end = text.find_last_of("0123456789.") + 1;
  const std::size_t begin = std::min(text.find_first_not_of(' ', end), text.size());
  const std::optional<double> value = to_number(text.substr(0, end));
  for (const auto& [unit, size] : units) {
    if (value && *value > 0 && text.substr(begin) == unit) return *value * size;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> to_number(const std::string& text) {
  return text.starts_with('+') ? std::nullopt : finite_number(text);
}

std::vector<std::string> split(const std::string& text) {
  constexpr const char* separators = " \t\r,";
  std::vector<std::string> parts;
  std::size_t begin = text.find_first_not_of(separators);
  while (begin != std::string::npos) {
    const std::size_t end = text.find_first_of(separators, begin);
    parts.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(separators, end);
  }
  return parts;
}

UsageError refusal(const std::string& option, const std::string& found, const std::string& expected) {
  return UsageError(option + ": found '" + found + "'; expected " + expected);
}

double number(const std::string& option, const std::string& text, const std::string& expected,
              const std::function<bool(double)>& accepted) {
  const std::optional<double> value = to_number(text);
  if (!value || !accepted(*value)) throw refusal(option, text, expected);
  return *value;
}

std::uint64_t whole_number(const std::string& option, const std::string& text, std::uint64_t lower,
                           std::uint64_t upper) {
  const auto value = whole_number_in<std::uint64_t>(text);
  if (value && *value >= lower && *value <= upper) return *value;
  throw refusal(option, text, "a whole number from " + std::to_string(lower) + " to " + std::to_string(upper));
}

double bytes(const std::string& option, const std::string& text) {
  constexpr std::array<Unit, 8> units = {{{"", 1},
                                          {"B", 1},
                                          {"kB", 1e3},
                                          {"MB", 1e6},
                                          {"GB", 1e9},
                                          {"TB", 1e12},
                                          {"MiB", 1024.0 * 1024},
                                          {"GiB", 1024.0 * 1024 * 1024}}};
  if (const std::optional<double> value = quantity(text, units)) return *value;
  throw refusal(option, text, "a size above 0, e.g. 2GB, 512MiB or '2 GB'; units: B, kB, MB, GB, TB, MiB, GiB");
}

double seconds(const std::string& option, const std::string& text) {
  constexpr std::array<Unit, 3> units = {{{"s", 1}, {"min", 60}, {"h", 3600}}};
  if (const std::optional<double> value = quantity(text, units)) return *value;
  throw refusal(option, text, "a time above 0, e.g. 30s, 2min or '1 h'; units: s, min, h");
}

double length(const std::string& option, const std::string& text) {
  if (const std::optional<double> value = quantity(text, units_of_length)) return *value;
  throw refusal(option, text, "a length above 0, e.g. 5cm or 0.05; units: m, cm, mm, in, ft");
}

double relative_error(const std::string& option, const std::string& text) {
  const bool percent = text.ends_with('%');
  const std::size_t end = percent ? text.find_last_not_of(" %") + 1 : text.size();
  const bool once = std::count(text.begin(), text.end(), '%') <= 1;
  const std::optional<double> value = to_number(text.substr(0, end));
  const double error = value ? *value / (percent ? 100 : 1) : 0;
  if (once && error > 0 && error < 1) return error;
  const bool meant_in_percent = !percent && error >= 1 && error < 100;
  throw refusal(
      option, text,
      "an error above 0 and below 100%, e.g. 1% or 0.01" + (meant_in_percent ? "; did you mean " + text + "%?" : ""));
}

double share(const std::string& option, const std::string& text) {
  const std::size_t end = text.find_last_not_of(" %") + 1;
  const std::optional<double> value = to_number(text.substr(0, end));
  const bool is_share = text.find('%') != std::string::npos && text.find('%') == text.rfind('%');
  if (!value || !is_share || !(*value > 0)) throw refusal(option, text, "a percentage above 0, e.g. 5%");
  return *value / 100;
}

Point point(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = split(text);
  Point result = Point::Zero();
  const std::string expected = "three numbers X,Y,Z, e.g. 4,-3,1.6";
  if (parts.size() != 3) throw refusal(option, text, expected);
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = to_number(parts[axis]);
    if (!value) throw refusal(option, text, expected);
    result[axis] = *value;
  }
  return result;
}

std::vector<std::pair<std::string, double>> length_units() {
  return {units_of_length.begin() + 1, units_of_length.end()};
}

double tolerance(const std::string& option, const std::string& text, double least) {
  const std::string lower = least > 0 ? "from " + rounded(least) + " to" : "above 0 and";
  return number(option, text, "a number " + lower + " below 1",
                [least](double x) { return x > 0 && x >= least && x < 1; });
}

Solver solver_named(const std::string& option, const std::string& text) {
  std::vector<std::pair<std::string, Solver>> allowed;
  for (const Solver solver : all_solvers()) allowed.emplace_back(name_of(solver), solver);
  return choice<Solver>(option, text, allowed);
}

std::string solver_names(const std::string& separator) {
  return listed_as(
      all_solvers(), [](Solver solver) { return name_of(solver); }, separator);
}

}  // namespace patchlight::cli
