#pragma once

#include "patchlight/scene/scene.h"

#include <array>
#include <vector>

namespace patchlight {

/// The straight pieces along which a plane, through `on` across `normal`, cuts the polygons of a scene; nothing of
/// polygons that lie in it.
std::vector<std::array<Point, 2>> section_of(const Scene& scene, const Point& on, const Vector& normal);

}  // namespace patchlight
