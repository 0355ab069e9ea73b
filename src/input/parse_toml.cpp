#include "patchlight/base/error.h"

#include "input/toml_value.h"

#include <algorithm>
#include <sstream>
#include <toml++/toml.h>

namespace patchlight {
namespace {

using Kind = TomlValue::Kind;

std::string place(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line);
}

Kind kind_of(const toml::node& node) {
  if (node.is_boolean()) return Kind::truth;
  if (node.is_number()) return Kind::number;
  if (node.is_string()) return Kind::text;
  if (node.is_date_time()) return Kind::time;
  if (node.is_array()) return Kind::list;
  return node.is_table() ? Kind::table : Kind::other;
}

std::string description(const toml::node& node) {
  if (const auto* const list = node.as_array()) {
    return "a list of " + std::to_string(list->size()) + (list->size() == 1 ? " value" : " values");
  }
  if (node.is_table()) return "a table";
  if (const auto* const word = node.as_string()) {
    std::string quoted = std::string("'").append(word->get()).append("'");
    std::replace(quoted.begin(), quoted.end(), '\n', ' ');  // messages are one line
    return quoted;
  }
  std::ostringstream text;
  node.visit([&text](const auto& value) {
    if constexpr (toml::is_value<decltype(value)>) text << value.get();
  });
  return text.str();
}

TomlTime time_of(const toml::date_time& given) {
  TomlTime time{given.date.year, given.date.month, given.date.day, given.time.hour, given.time.minute, 0, {}};
  time.second = given.time.second + 1e-9 * given.time.nanosecond;
  if (given.offset) time.minutes_east = given.offset->minutes;
  return time;
}

// The value with all that is in it. Values of tables in a list are named like those of a table.
TomlValue value_of(const toml::node& node, const std::string& file, const std::string& name) {
  TomlValue value;
  value.kind = kind_of(node);
  value.where = place(file, node.source());
  value.name = name;
  value.found = description(node);
  value.truth = node.value_or(false);
  value.number = node.is_number() ? node.value_or(0.0) : 0;
  value.text = node.is_string() ? node.value_or(std::string()) : "";
  if (const auto* const time = node.as_date_time()) value.time = time_of(time->get());
  if (const auto* const list = node.as_array()) {
    for (const toml::node& item : *list) value.items.push_back(value_of(item, file, name));
  }
  if (const auto* const table = node.as_table()) {
    for (const auto& [key, item] : *table) {
      const std::string word(key.str());
      value.keys.push_back(word);
      value.lines.push_back(place(file, key.source()));
      value.items.push_back(value_of(item, file, name.empty() ? word : name + "." + word));
    }
  }
  return value;
}

}  // namespace

TomlValue parse_toml(std::string_view text, const std::string& file) {
  try {
    TomlValue value = value_of(toml::parse(text, file), file, "");
    value.where = file;
    return value;
  } catch (const toml::parse_error& error) {
    throw InputError(place(file, error.source()), "is not TOML: " + std::string(error.description()));
  }
}

}  // namespace patchlight
