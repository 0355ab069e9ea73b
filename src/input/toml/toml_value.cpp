#include "input/toml/toml_value.h"

#include "patchlight/base/error.h"

#include "base/near_match.h"
#include "input/text.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

bool is_spectrum(const TomlValue& value) {
  if (value.kind == TomlValue::Kind::number) return true;
  return value.kind == TomlValue::Kind::list && value.items.size() == 3;
}

}  // namespace

void refuse(const TomlValue& value, const std::string& expected) {
  throw InputError(value.where, value.name + ": found " + value.found + "; expected " + expected);
}

const TomlValue* find(const TomlValue& table, std::string_view key) {
  const auto found = std::find(table.keys.begin(), table.keys.end(), key);
  return found == table.keys.end() ? nullptr : &table.items[static_cast<std::size_t>(found - table.keys.begin())];
}

const TomlValue& required(const TomlValue& table, std::string_view key, const std::string& expected) {
  if (const TomlValue* const value = find(table, key)) return *value;
  throw InputError(table.where, table.name + ": found no key '" + std::string(key) + "'; expected " + expected);
}

std::string one_of(const TomlValue& table, const std::vector<std::string>& keys) {
  std::vector<std::string> given;
  std::copy_if(keys.begin(), keys.end(), std::back_inserter(given),
               [&](const std::string& key) { return find(table, key) != nullptr; });
  if (given.size() == 1) return given[0];
  throw InputError(table.where, table.name + ": found " + (given.empty() ? "none of them" : listed(given)) +
                                    "; expected one of " + listed(keys));
}

void allow_keys(const TomlValue& table, const std::vector<std::string>& keys) {
  if (table.kind != TomlValue::Kind::table) refuse(table, "a table with keys " + listed(keys));
  for (std::size_t k = 0; k < table.keys.size(); ++k) {
    const std::string& key = table.keys[k];
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const std::string of = table.name.empty() ? "" : " of " + table.name;
    const std::string hint = suggestion(key, keys);
    throw InputError(table.lines[k], "unknown key '" + key + "'" + of + hint +
                                         (hint.empty() ? "; expected one of " : " Expected one of ") + listed(keys));
  }
}

std::vector<TomlValue> tables(const TomlValue* list) {
  if (list == nullptr) return {};
  const bool all_tables = list->kind == TomlValue::Kind::list &&
                          std::all_of(list->items.begin(), list->items.end(),
                                      [](const auto& v) { return v.kind == TomlValue::Kind::table; });
  if (!all_tables) refuse(*list, "tables [[" + list->name + "]], in double brackets");
  return list->items;
}

double number(const TomlValue& value, const std::string& expected) {
  if (value.kind != TomlValue::Kind::number || !std::isfinite(value.number)) refuse(value, expected);
  return value.number;
}

double positive(const TomlValue& value) {
  if (!(number(value, "a number above 0") > 0)) refuse(value, "a number above 0");
  return value.number;
}

double not_negative(const TomlValue& value) {
  if (!(number(value, "a number, 0 or more") >= 0)) refuse(value, "a number, 0 or more");
  return value.number;
}

std::vector<double> numbers(const TomlValue& value, std::size_t count, const std::string& expected) {
  if (value.kind != TomlValue::Kind::list || value.items.size() != count) refuse(value, expected);
  std::vector<double> values;
  for (const TomlValue& item : value.items) values.push_back(number(item, expected));
  return values;
}

Vector vector(const TomlValue& value) { return Vector(numbers(value, 3, "three numbers [x, y, z]").data()); }

Vector direction(const TomlValue& value) {
  const Vector given = vector(value);
  if (!(given.stableNorm() > 0)) refuse(value, "three numbers [x, y, z], not all 0");
  return given.stableNormalized();
}

Spectrum spectrum(const TomlValue& value) {
  const std::string expected = "a number for all bands, or three: [R, G, B]";
  if (!is_spectrum(value)) refuse(value, expected);
  if (value.kind == TomlValue::Kind::number) return Spectrum::Constant(1, not_negative(value));
  const std::vector<double> values = numbers(value, 3, expected);
  for (const TomlValue& item : value.items) not_negative(item);
  return rgb(values[0], values[1], values[2]);
}

std::string text(const TomlValue& value, const std::string& expected) {
  if (value.kind != TomlValue::Kind::text || value.text.empty()) refuse(value, expected);
  return value.text;
}

std::vector<std::string> texts(const TomlValue& value, const std::string& expected) {
  if (value.kind != TomlValue::Kind::list) return {text(value, expected)};
  std::vector<std::string> all;
  for (const TomlValue& item : value.items) all.push_back(text(item, expected));
  return all;
}

std::filesystem::path path(const TomlValue& value, const std::filesystem::path& file) {
  return (file.parent_path() / text(value, "the name of a file")).lexically_normal();
}

double unit_length(const TomlValue& value) { return choice<double>(value, {units.begin(), units.end()}); }

Vector upright(const TomlValue& value) {
  return choice<Vector>(value, {{"y", Vector::UnitY()}, {"z", Vector::UnitZ()}});
}

}  // namespace patchlight
