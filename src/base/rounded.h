#pragma once

#include <string>

namespace patchlight {

/// The shortest decimal that reads back as the same number.
std::string shortest(double number);

/// A number with `digits` significant digits, for people to read; "-" if it is not finite.
std::string rounded(double value, int digits = 3);

/// A share in percent, without the sign, with `digits` significant digits.
std::string percent(double share, int digits = 3);

}  // namespace patchlight
