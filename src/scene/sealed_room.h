#pragma once

#include "patchlight/scene/scene.h"

#include "scene/solids.h"

#include <optional>

namespace patchlight {

/// The closed solid without clear faces and sheets that holds all of a scene, if there is one: no daylight gets into
/// it. What lies far from the scene, far_polygons(), does not count. Of each other shell one point is looked at, of
/// so many, spread evenly, as take 1e7 tests of a triangle, half a second, and of 16 at least. O(n log n) for n
/// corners, expected, and these tests for each closed solid as large as the scene.
std::optional<Solid> sealed_hull(const Scene& scene);

/// True when a sealed hull is that of a room, not of a body that is seen from outside: its fronts face inside,
/// something stands in it, or the scene names its rooms.
bool is_room(const Scene& scene, const Solid& hull);

/// A place for a lamp in a room: a tenth of its height under its top, over its middle, or where that lies outside, as
/// far under the largest triangle of its ceiling that has room below; nothing where none has. Of n triangles of the
/// room as many, the largest first, are looked at as take 1e7 tests of a triangle, half a second, and 16 at least:
/// O(n log n).
std::optional<Point> place_under_ceiling(const Scene& scene, const Solid& room);

}  // namespace patchlight
