#pragma once

#include <string>

namespace patchlight {

/// The number with as few digits as tell it from every other.
std::string shortest(double number);

/// A number with so many digits, for people to read; "-" for what is not finite.
std::string rounded(double value, int digits = 3);

/// A share in percent, without the sign, with so many digits.
std::string percent(double share, int digits = 3);

}  // namespace patchlight
