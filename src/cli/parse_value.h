#pragma once

#include "patchlight/base/geometry.h"

#include "cli/arguments.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {

/// The finite number that all of `text` stands for, with a decimal point whatever the locale; nothing otherwise.
std::optional<double> to_number(const std::string& text);

/// The parts of `text` between spaces, tabs and commas, empty parts left out.
std::vector<std::string> split(const std::string& text);

/// The value of an option as a number that `accepted` likes; `expected` describes it. \throws UsageError.
double number(const std::string& option, const std::string& text, const std::string& expected,
              const std::function<bool(double)>& accepted);

/// The value of an option as a whole number from `lower` to `upper`. \throws UsageError.
std::uint64_t whole_number(const std::string& option, const std::string& text, std::uint64_t lower,
                           std::uint64_t upper);

/// The value of an option as a number of bytes, as in 2GB, 512 MiB or 2e9. \throws UsageError.
double bytes(const std::string& option, const std::string& text);

/// The value of an option as a share above 0, as 0.05 for 5%. \throws UsageError.
double share(const std::string& option, const std::string& text);

/// The value of an option as a relative error above 0 and below 1: 0.01 for 1% and for 0.01. \throws UsageError.
double relative_error(const std::string& option, const std::string& text);

/// The value of an option as a time above 0 in seconds, as in 30s, 2 min or 1h. \throws UsageError.
double seconds(const std::string& option, const std::string& text);

/// The value of an option as a length above 0 in metres, as in 5cm, '50 mm' or 0.05. \throws UsageError.
double length(const std::string& option, const std::string& text);

/// The value of an option as a point X,Y,Z. \throws UsageError.
Point point(const std::string& option, const std::string& text);

/// The value of --unit, m, cm, mm, in or ft, in metres. \throws UsageError.
double unit_length(const std::string& text);

/// What a solver's name stands for. \throws UsageError.
Solver solver_named(const std::string& option, const std::string& text);

/// The solvers' names.
std::string solver_names(const std::string& separator);

/// The sentence that refuses a value.
UsageError refusal(const std::string& option, const std::string& found, const std::string& expected);

/// What one of several allowed words stands for. \throws UsageError that lists them.
template <typename Value>
Value choice(const std::string& option, const std::string& text,
             const std::vector<std::pair<std::string, Value>>& allowed) {
  std::string words;
  for (const auto& [word, value] : allowed) {
    if (word == text) return value;
    words += (words.empty() ? "" : ", ") + word;
  }
  throw refusal(option, text, allowed.size() > 1 ? "one of " + words : words);
}

}  // namespace patchlight::cli
