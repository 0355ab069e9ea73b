#pragma once

#include <string>

namespace patchlight {

/// The text with the capital letters of ASCII made small, whatever the process's locale: that of Turkish keeps I.
inline std::string in_lower_case(std::string text) {
  for (char& letter : text) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return text;
}

}  // namespace patchlight
