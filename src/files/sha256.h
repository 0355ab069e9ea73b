#pragma once

#include <span>
#include <string>

namespace patchlight {

/// SHA-256 (FIPS 180-4) of the concatenated parts, in 64 lower-case hexadecimal digits.
std::string sha256(std::span<const std::string> parts);

}  // namespace patchlight
