#include "lighting/shifted_points.h"

#include "base/sampling.h"

#include <cstddef>

namespace patchlight {

std::vector<std::array<double, 4>> shifted(std::span<const std::array<double, 4>> points, std::uint32_t key) {
  constexpr double steps = 0x1p32;
  std::array<std::uint32_t, 4> shift;
  for (std::uint32_t d = 0; d < 4; ++d) shift[d] = hash({key, d});
  std::vector<std::array<double, 4>> moved(points.begin(), points.end());
  for (std::array<double, 4>& point : moved) {
    for (std::size_t d = 0; d < 4; ++d)
      point[d] = (static_cast<double>(static_cast<std::uint32_t>(point[d] * steps) ^ shift[d]) + 0.5) / steps;
  }
  return moved;
}

}  // namespace patchlight
