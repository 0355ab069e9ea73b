#pragma once

#include "patchlight/scene/scene.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// Per polygon 1 when all vertices of the scene lie on one side of its plane, up to 1e-6 of the scene's extent: such a
/// polygon is part of the convex hull and cannot stand between two points of the scene.
/// O(polygons) for most scenes, O(polygons x vertices) for convex ones.
std::vector<std::uint8_t> on_convex_hull(const Scene& scene);

}  // namespace patchlight
