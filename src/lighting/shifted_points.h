#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Points of the unit cube moved by a digital shift that follows from a key, so that no two receivers have the same:
/// errors of several lamps add up as independent ones do.
std::vector<std::array<double, 4>> shifted(std::span<const std::array<double, 4>> points, std::uint32_t key);

}  // namespace patchlight
