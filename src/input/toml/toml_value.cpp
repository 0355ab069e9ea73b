#include "input/toml/toml_value.h"

#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/text.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <toml++/toml.h>

namespace patchlight {
namespace {

// The text after a leading string or comment; the whole text without one.
std::string_view after_string(std::string_view text) {
  if (text[0] == '#') return text.substr(std::min(text.find('\n'), text.size()));
  if (text[0] != '"' && text[0] != '\'') return text;
  const bool has_escapes = text[0] == '"';
  const std::string_view one = text.substr(0, 1);
  const std::string_view three = has_escapes ? R"(""")" : "'''";
  const std::string_view end = text.starts_with(three) ? three : one;
  std::size_t k = end.size();
  while (k < text.size() && !text.substr(k).starts_with(end)) k += has_escapes && text[k] == '\\' ? 2 : 1;
  return text.substr(std::min(k + end.size(), text.size()));
}

// The nesting depth of a text, computed without recursion from brackets and dots of keys.
class Levels {
 public:
  void take(char letter) {
    if (letter == '[' || letter == '{') {
      outer_.push_back(now_);
      ++now_;
    } else if ((letter == ']' || letter == '}') && !outer_.empty()) {
      now_ = outer_.back();
      outer_.pop_back();
    } else if (letter == ',' || letter == '\n') {
      now_ = outer_.empty() ? 0 : outer_.back() + 1;
    } else if (letter == '.') {
      ++now_;
    }
  }
  std::size_t now() const { return now_; }

 private:
  std::size_t now_ = 0;
  std::vector<std::size_t> outer_;
};

void require_few_levels(std::string_view text, const std::string& file) {
  Levels levels;
  std::size_t line = 1;
  std::size_t values = 0;
  while (!text.empty()) {
    const std::string_view rest = after_string(text);
    line += static_cast<std::size_t>(std::count(text.begin(), text.begin() + (text.size() - rest.size()), '\n'));
    if (rest.size() < text.size()) {
      text = rest;
      continue;
    }
    levels.take(text[0]);
    values += text[0] == ',' || text[0] == '=' || text[0] == '[' || text[0] == '{' ? 1 : 0;
    line += text[0] == '\n' ? 1 : 0;
    const std::string where = file + ":";
    if (levels.now() > reading_limits::nesting) {
      throw InputError(where + std::to_string(line), "found tables or lists more than " +
                                                         std::to_string(reading_limits::nesting) +
                                                         " deep; expected the keys of a scene file");
    }
    if (values > reading_limits::values) {
      throw InputError(where + std::to_string(line),
                       "found more than " + std::to_string(reading_limits::values) +
                           " values\nhint: put points into a file of their own: file = \"...\"");
    }
    text.remove_prefix(1);
  }
}

std::string place(const std::string& file, const toml::source_region& source) {
  return file + ":" + std::to_string(source.begin.line);
}

TomlValue::Kind kind_of(const toml::node& node) {
  if (node.is_boolean()) return TomlValue::Kind::truth;
  if (node.is_number()) return TomlValue::Kind::number;
  if (node.is_string()) return TomlValue::Kind::text;
  if (node.is_date_time()) return TomlValue::Kind::time;
  if (node.is_array()) return TomlValue::Kind::list;
  return node.is_table() ? TomlValue::Kind::table : TomlValue::Kind::other;
}

// Messages have one line.
std::string on_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string description(const toml::node& node) {
  if (const auto* const list = node.as_array()) {
    return "a list of " + std::to_string(list->size()) + (list->size() == 1 ? " value" : " values");
  }
  if (node.is_table()) return "a table";
  if (const auto* const word = node.as_string()) {
    return on_one_line(std::string("'").append(word->get()).append("'"));
  }
  std::ostringstream text;
  if (const auto* const number = node.as_floating_point()) {
    text << shortest(number->get());
  } else {
    node.visit([&text](const auto& value) {
      if constexpr (toml::is_value<decltype(value)>) text << value.get();
    });
  }
  return text.str();
}

TomlTime time_of(const toml::date_time& given) {
  TomlTime time{given.date.year, given.date.month, given.date.day, given.time.hour, given.time.minute, 0, {}};
  time.second = given.time.second + 1e-9 * given.time.nanosecond;
  if (given.offset) time.minutes_east = given.offset->minutes;
  return time;
}

// Converts a node recursively. Values of tables in a list are named like those of a table.
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
      if (word.size() > reading_limits::key_length) {
        throw InputError(place(file, key.source()),
                         "found a key of " + std::to_string(word.size()) + " letters; expected a key of a scene file");
      }
      value.keys.push_back(word);
      value.lines.push_back(place(file, key.source()));
      value.items.push_back(value_of(item, file, name.empty() ? word : name + "." + word));
    }
  }
  return value;
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

double within(const TomlValue& value, double low, double high, const std::string& expected) {
  if (!(number(value, expected) >= low && value.number <= high)) refuse(value, expected);
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
  if (value.kind == TomlValue::Kind::number) return Spectrum::Constant(1, not_negative(value));
  const std::vector<double> values = numbers(value, 3, "a number for all bands, or three: [R, G, B]");
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

TomlValue parse_toml(std::string_view text, const std::string& file) {
  require_few_levels(text, file);
  try {
    TomlValue value = value_of(toml::parse(text, file), file, "");
    value.where = file;
    return value;
  } catch (const toml::parse_error& error) {
    throw InputError(place(file, error.source()), "is not TOML: " + on_one_line(std::string(error.description())));
  }
}

}  // namespace patchlight
