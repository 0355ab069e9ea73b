#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <algorithm>
#include <cstddef>

namespace patchlight {

/// The square of the longest edge of a patch, m^2.
inline double longest_edge_squared(const PatchCorners& corners) {
  const auto count = static_cast<std::size_t>(corners.count);
  double longest = 0;
  for (std::size_t k = 0; k < count; ++k)
    longest = std::max(longest, (corners.points[(k + 1) % count] - corners.points[k]).squaredNorm());
  return longest;
}

}  // namespace patchlight
