#include "base/shortest.h"

#include <array>
#include <charconv>

namespace patchlight {

std::string shortest(double number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), end};
}

}  // namespace patchlight
