#include "patchlight/base/error.h"

#include "base/rounded.h"
#include "input/reading_limits.h"
#include "input/toml/toml_value.h"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <toml++/toml.h>

namespace patchlight {
namespace {

// What follows the string or comment that the text begins with; the whole text when it begins with neither.
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

// The levels that a text goes down to, found without going down: brackets, and dots of keys.
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

// Messages are one line.
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
