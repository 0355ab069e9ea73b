#pragma once

#include "patchlight/scene/scene.h"

#include "scene/solids.h"

#include <optional>

namespace patchlight {

/// The closed solid without clear faces and sheets that holds all of a scene, if there is one: no daylight gets into
/// it. O(n log n) for n corners, expected.
std::optional<Solid> sealed_hull(const Scene& scene);

/// True when a sealed hull is that of a room, not of a body that is seen from outside: its fronts face inside,
/// something stands in it, or the scene names its rooms.
bool is_room(const Scene& scene, const Solid& hull);

/// A place for a lamp in a room: a tenth of its height under its top, over its middle, or where that lies outside,
/// under the largest part of its ceiling that has room below.
Point place_under_ceiling(const Scene& scene, const Solid& room);

}  // namespace patchlight
