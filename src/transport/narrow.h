#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace patchlight {

/// The float nearest to `value` that is not farther from zero.
inline float narrow_toward_zero(double value) {
  const auto nearest = static_cast<float>(value);
  if (!(std::abs(static_cast<double>(nearest)) > std::abs(value))) return nearest;
  // The next float toward zero: one less in the bits after the sign, which order floats by their size.
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(nearest) - 1);
}

}  // namespace patchlight
