#pragma once

#include <span>
#include <string>

namespace patchlight {

/// "a, b, c" of up to eight names, "and 3 more" of the rest.
std::string first_few(std::span<const std::string> names);

}  // namespace patchlight
