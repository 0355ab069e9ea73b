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
  std::optional<int> minutes_east;  ///< of Greenwich; not given for a local time
};

/// A value of a TOML file, with what messages about it need.
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
  std::vector<std::string> lines;  ///< of a table, where each key stands
};

/// The table that a TOML text is. \throws InputError with the line when it is not TOML.
TomlValue parse_toml(std::string_view text, const std::string& file);

/// \throws InputError: "found ...; expected ...", naming file, line and key.
[[noreturn]] void refuse(const TomlValue& value, const std::string& expected);

/// The value of a key; null when the table does not have it.
const TomlValue* find(const TomlValue& table, std::string_view key);

/// The value of a key that must be there. \throws InputError.
const TomlValue& required(const TomlValue& table, std::string_view key, const std::string& expected);

/// The one key of several that the table has. \throws InputError when it has none of them or more than one.
std::string one_of(const TomlValue& table, const std::vector<std::string>& keys);

/// \throws InputError when the value is no table, or has a key that is not allowed: it names a near match.
void allow_keys(const TomlValue& table, const std::vector<std::string>& keys);

/// The tables of a list [[...]]; none for null. \throws InputError when it is something else.
std::vector<TomlValue> tables(const TomlValue* list);

// The value as something. Each throws an InputError that states the expected form.
double number(const TomlValue& value, const std::string& expected = "a number");  ///< finite
double within(const TomlValue& value, double low, double high, const std::string& expected);
double positive(const TomlValue& value);
double not_negative(const TomlValue& value);
std::vector<double> numbers(const TomlValue& value, std::size_t count, const std::string& expected);
Vector vector(const TomlValue& value);
Vector direction(const TomlValue& value);   ///< three numbers that are not all zero, made a unit vector
Spectrum spectrum(const TomlValue& value);  ///< one number not below 0, or three: R, G, B

/// The value as a text that is not empty, or as a list of them or one alone.
std::string text(const TomlValue& value, const std::string& expected = "a text");
std::vector<std::string> texts(const TomlValue& value, const std::string& expected);

/// The value as a path; relative ones start from the folder of `file`.
std::filesystem::path path(const TomlValue& value, const std::filesystem::path& file);

/// The value that one of several allowed words stands for.
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
