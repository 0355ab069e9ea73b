#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace patchlight {

/// A date and time of a TOML file.
struct TomlTime {
  int year = 0, month = 0, day = 0;
  int hour = 0, minute = 0;
  double second = 0;
  std::optional<int> minutes_east;  ///< of Greenwich; empty for a local time
};

/// A value of a TOML file, with its place for messages.
struct TomlValue {
  enum class Kind { truth, number, text, time, list, table, other };
  Kind kind = Kind::table;
  std::string where;  ///< "room.toml:12"
  std::string name;   ///< "sensors.spacing"
  std::string found;  ///< "'abc'", "3.5", "a list of 2 values"
  bool truth = false;
  double number = 0;
  std::string text;
  TomlTime time;
  std::vector<TomlValue> items;    ///< of a list or table
  std::vector<std::string> keys;   ///< of a table, one for each item
  std::vector<std::string> lines;  ///< of a table, the line of each key
};

/// The table of a TOML text. \throws InputError with the line for invalid TOML.
TomlValue parse_toml(std::string_view text, const std::string& file);

/// \throws InputError "found ...; expected ..." with file, line and key.
[[noreturn]] void refuse(const TomlValue& value, const std::string& expected);

/// The value of a key; null if absent.
const TomlValue* find(const TomlValue& table, std::string_view key);

/// The value of a required key. \throws InputError.
const TomlValue& required(const TomlValue& table, std::string_view key, const std::string& expected);

/// The only key among several that the table has. \throws InputError for none or more than one.
std::string one_of(const TomlValue& table, const std::vector<std::string>& keys);

/// \throws InputError when the value is no table, or has an unknown key; suggests a similar one.
void allow_keys(const TomlValue& table, const std::vector<std::string>& keys);

/// The tables of a list [[...]]; empty for null. \throws InputError for another value.
std::vector<TomlValue> tables(const TomlValue* list);

// Typed values. Each throws an InputError with the expected form.
double number(const TomlValue& value, const std::string& expected = "a number");  ///< finite
double within(const TomlValue& value, double low, double high, const std::string& expected);
double positive(const TomlValue& value);
double not_negative(const TomlValue& value);
std::vector<double> numbers(const TomlValue& value, std::size_t count, const std::string& expected);
Vector vector(const TomlValue& value);
Vector direction(const TomlValue& value);   ///< three numbers, not all zero, normalized
Spectrum spectrum(const TomlValue& value);  ///< one number >= 0, or three: R, G, B

/// The value as a text that is not empty, or as a list of texts or a single one.
std::string text(const TomlValue& value, const std::string& expected = "a text");
std::vector<std::string> texts(const TomlValue& value, const std::string& expected);

/// The value as a path; relative paths start at the folder of `file`.
std::filesystem::path path(const TomlValue& value, const std::filesystem::path& file);

/// The value of one of several allowed words.
template <typename Value>
Value choice(const TomlValue& value, const std::vector<std::pair<std::string, Value>>& allowed) {
  std::string words;
  for (const auto& [word, meaning] : allowed) {
    if (value.kind == TomlValue::Kind::text && word == value.text) return meaning;
    words += (words.empty() ? "'" : ", '") + word + "'";
  }
  refuse(value, "one of " + words);
}

/// The units of lengths, in meters.
inline constexpr std::array<std::pair<const char*, double>, 5> units = {
    {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};

/// The length of a unit in meters: m, cm, mm, in or ft.
double unit_length(const TomlValue& value);

/// The axis "y" or "z".
Vector upright(const TomlValue& value);

}  // namespace patchlight
