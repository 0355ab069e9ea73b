#pragma once

#include <span>
#include <string>

namespace patchlight {

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
