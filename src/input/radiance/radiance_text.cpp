#include "input/radiance/radiance_text.h"

#include "input/text.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace patchlight {
namespace {

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r') || c == '\0'; }

}  // namespace

void RadianceText::refuse(const std::string& message) const { throw InputError(at_line(file_, word_line_), message); }

bool RadianceText::has_more() {
  while (at_ < text_.size()) {
    if (text_[at_] == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (is_blank(text_[at_])) {
      line_ += text_[at_] == '\n';
      ++at_;
    } else {
      return true;
    }
  }
  return false;
}

std::string_view RadianceText::word(const std::string& what) {
  if (!has_more()) {
    word_line_ = line_;
    refuse("the file ends where " + what + " is expected\nhint: complete it, or export it again");
  }
  word_line_ = line_;
  const char quote = text_[at_];
  if (quote == '"' || quote == '\'') {
    const std::size_t end = std::min(text_.find(quote, at_ + 1), text_.find('\n', at_ + 1));
    if (end == std::string_view::npos || text_[end] == '\n') refuse("a quote is not closed on its line");
    const std::string_view found = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    return found;
  }
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::size_t RadianceText::count(const std::string& what) {
  const std::string_view found = word("the number of its " + what);
  const std::optional<double> number = finite_number(found);
  if (!number || *number < 0 || *number > 1e8 || std::floor(*number) != *number)
    refuse("found '" + std::string(found) + "' where the number of its " + what + " is expected, 0 or more");
  return static_cast<std::size_t>(*number);
}

// Reads to the end of the line; a backslash continues it.
std::string_view RadianceText::command() {
  word_line_ = line_;
  const std::size_t begin = ++at_;
  while (at_ < text_.size() && (text_[at_] != '\n' || text_[at_ - 1] == '\\')) {
    line_ += text_[at_] == '\n';
    ++at_;
  }
  return text_.substr(begin, at_ - begin);
}

RadiancePrimitive RadianceText::next() {
  RadiancePrimitive found;
  if (has_more() && text_[at_] == '!') {
    found.kind = "!";
    found.words = {std::string(command())};
    found.line = word_line_;
    return found;
  }
  found.modifier = word("the modifier of a primitive");
  found.line = word_line_;
  found.kind = word("the kind of a primitive");
  found.name = word("the name of a primitive");
  if (found.kind == "alias") {
    found.words.emplace_back(word("the name that an alias stands for"));
    return found;
  }
  for (std::size_t left = count("words"); left > 0; --left) found.words.emplace_back(word("a word"));
  for (std::size_t left = count("whole numbers"); left > 0; --left) word("a whole number");
  for (std::size_t left = count("numbers"); left > 0; --left) {
    const std::string_view text = word("a number");
    const std::optional<double> number = finite_number(text);
    if (!number)
      refuse("found '" + std::string(text) + "' where a number of " + found.kind + " " + found.name +
             " is expected; is the count before it right?");
    found.numbers.push_back(*number);
  }
  return found;
}

std::vector<std::vector<std::string>> piped_commands(std::string_view command) {
  std::vector<std::vector<std::string>> all(1);
  std::size_t at = 0;
  while (at < command.size()) {
    const char c = command[at];
    if (is_blank(c) || (c == '\\' && at + 1 < command.size() && is_blank(command[at + 1]))) {
      ++at;
      continue;
    }
    if (c == '|') {
      all.emplace_back();
      ++at;
      continue;
    }
    if (c == '"' || c == '\'') {
      const std::size_t end = command.find(c, at + 1);
      if (end == std::string_view::npos) return {};
      all.back().emplace_back(command.substr(at + 1, end - at - 1));
      at = end + 1;
      continue;
    }
    const std::size_t begin = at;
    while (at < command.size() && !is_blank(command[at]) && command[at] != '|') ++at;
    const std::string_view word = command.substr(begin, at - begin);
    if (word.find_first_of(";&<>`$*?()[]{}~\"'\\") != std::string_view::npos) return {};
    if (word.front() == '#') break;
    all.back().emplace_back(word);
  }
  const bool is_cut = std::any_of(all.begin(), all.end(), [](const auto& words) { return words.empty(); });
  return is_cut ? std::vector<std::vector<std::string>>() : all;
}

}  // namespace patchlight
