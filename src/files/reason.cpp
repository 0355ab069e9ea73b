#include "files/reason.h"

#include <algorithm>
#include <new>
#include <stdexcept>

namespace patchlight {

std::string reason_of(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
      dynamic_cast<const std::length_error*>(&error) != nullptr)
    return "a size in it needs more memory than there is";
  std::string text = error.what();
  if (text.find("::_M_") != std::string::npos) return "a number in it refers to nothing";
  if (text.starts_with("[json.exception")) text.erase(0, std::min(text.size(), text.find("] ") + 2));
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace patchlight
