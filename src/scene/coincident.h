#pragma once

#include "patchlight/scene/scene.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// Polygons with the same corners in the same or the opposite order.
struct Coincidence {
  struct Pair {
    PolygonIndex first, second;  // the first polygon at a place, and another one there
    bool same_front;
  };
  std::vector<Pair> pairs;              ///< by `second`
  std::vector<std::uint8_t> is_second;  ///< per polygon
};

/// Compares the indices of corners: vertices have to be welded.
Coincidence find_coincident(const Scene& scene);

}  // namespace patchlight
