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

/// The finite number in `text`, with a decimal point in every locale; empty otherwise.
std::optional<double> to_number(const std::string& text);

/// The parts of `text` between spaces, tabs and commas, without empty parts.
std::vector<std::string> split(const std::string& text);

// Parsers for option values. Each throws a UsageError that names the option.

/// A number that satisfies `accepted`; `expected` describes it.
double number(const std::string& option, const std::string& text, const std::string& expected,
              const std::function<bool(double)>& accepted);

/// A whole number from `lower` to `upper`.
std::uint64_t whole_number(const std::string& option, const std::string& text, std::uint64_t lower,
                           std::uint64_t upper);

double bytes(const std::string& option, const std::string& text);           ///< 2GB, 512 MiB or 2e9
double share(const std::string& option, const std::string& text);           ///< above 0: 0.05 for 5%
double relative_error(const std::string& option, const std::string& text);  ///< above 0, below 1: 0.01 for 1% and 0.01
double seconds(const std::string& option, const std::string& text);         ///< above 0: 30s, 2 min or 1h
double length(const std::string& option, const std::string& text);  ///< above 0, in meters: 5cm, '50 mm' or 0.05
Point point(const std::string& option, const std::string& text);    ///< X,Y,Z

/// A number from `least` (0: above 0) to below 1.
double tolerance(const std::string& option, const std::string& text, double least);

/// The units of lengths, in meters: m, cm, mm, in and ft.
std::vector<std::pair<std::string, double>> length_units();

/// The solver of that name. \throws UsageError.
Solver solver_named(const std::string& option, const std::string& text);

/// The solvers' names.
std::string solver_names(const std::string& separator);

/// The error for an invalid value.
UsageError refusal(const std::string& option, const std::string& found, const std::string& expected);

/// The value of one of several allowed words. \throws UsageError with the list of words.
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
