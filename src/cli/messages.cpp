#include "cli/messages.h"

#include <algorithm>
#include <iostream>

namespace patchlight::cli {

void print_message(const char* kind, const std::string& text) {
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::cerr << "patchlight: " << kind << ": " << line << '\n';
}

}  // namespace patchlight::cli
