#pragma once

#include <string>

namespace patchlight {

/// The number with as few digits as tell it from every other.
std::string shortest(double number);

}  // namespace patchlight
