#pragma once

#include <cmath>

namespace patchlight {

/// The float nearest to `value` that is not farther from zero.
inline float narrow_toward_zero(double value) {
  const auto nearest = static_cast<float>(value);
  return std::abs(static_cast<double>(nearest)) > std::abs(value) ? std::nextafter(nearest, 0.0F) : nearest;
}

}  // namespace patchlight
