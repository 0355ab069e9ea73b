#pragma once

#include <string>

/// A message is one line, perhaps with a second one that gives a remedy.
inline bool is_good_message(const std::string& message) {
  const std::size_t end = message.find('\n');
  if (end == 0 || message.empty()) return false;
  return end == std::string::npos ||
         (message.compare(end + 1, 6, "hint: ") == 0 && message.find('\n', end + 1) == std::string::npos);
}
