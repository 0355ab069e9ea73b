#pragma once

#include "patchlight/scene/sides.h"

#include "gather/facets.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Per point 1 when it is inside a wall, as place_sensors() has it.
std::vector<std::uint8_t> inside_walls(const Scene& scene, const KeptSides& sides, const Occluder& occluder,
                                       std::span<const Facet> facets, std::span<const Point> points);

}  // namespace patchlight
