#pragma once

#include "patchlight/scene/scene.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// Per polygon 1 when a vertex of the scene lies before its front, and behind it, by more than 1e-6 of the scene's
/// extent.
struct HalfSpaces {
  std::vector<std::uint8_t> before;
  std::vector<std::uint8_t> behind;
};

/// O(n log n) for most scenes of n vertices and polygons.
HalfSpaces occupied_half_spaces(const Scene& scene);

}  // namespace patchlight
