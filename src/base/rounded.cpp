#include "base/rounded.h"

#include <array>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace patchlight {

std::string shortest(double number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), end};
}

std::string rounded(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  // 2000 rather than 2e+03.
  constexpr double least_with_exponent = 1e6;
  const double size = std::abs(value);
  const double step =
      size < least_with_exponent && size >= 1 ? std::pow(10, std::floor(std::log10(size)) - digits + 1) : 0;
  std::ostringstream text;
  if (step > 1) {
    text << std::fixed << std::setprecision(0) << std::round(value / step) * step;
  } else {
    text << std::setprecision(digits) << value;
  }
  return text.str();
}

std::string percent(double share, int digits) { return rounded(100 * share, digits); }

}  // namespace patchlight
