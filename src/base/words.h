#pragma once

#include <cstddef>
#include <span>
#include <string>

// Numbers, lists and words as messages show them.
namespace patchlight {

/// The shortest decimal that reads back as the same number.
std::string shortest(double number);

/// A number with `digits` significant digits, for people to read; "-" if it is not finite.
std::string rounded(double value, int digits = 3);

/// A share in percent, without the sign, with `digits` significant digits.
std::string percent(double share, int digits = 3);

/// "a, b, c".
std::string listed(std::span<const std::string> texts, const std::string& separator = ", ");

/// The same of values, each as text_of(value).
std::string listed_as(const auto& values, const auto& text_of, const std::string& separator = ", ") {
  std::string list;
  for (const auto& value : values) list += (list.empty() ? "" : separator) + text_of(value);
  return list;
}

/// "a, b, c" of up to `few` texts, "and 3 more" of the rest.
std::string first_few(std::span<const std::string> texts, std::size_t few = 8);

/// The text with the capital letters of ASCII made small, whatever the process's locale: that of Turkish keeps I.
inline std::string in_lower_case(std::string text) {
  for (char& letter : text) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return text;
}

/// The word among `allowed` that `found` is most likely a slip for: the one with the fewest letters inserted, removed
/// or replaced, at most two and fewer than half of its own; the first of equals. Empty when there is none.
std::string near_match(const std::string& found, std::span<const std::string> allowed);

/// "; did you mean 'wall'?", or nothing without a near match.
std::string suggestion(const std::string& found, std::span<const std::string> allowed);

/// A word as one would type it in a POSIX shell: in single quotes unless it consists of letters, digits and signs of
/// ASCII that no shell takes for anything else.
std::string shell_word(const std::string& word);

}  // namespace patchlight
