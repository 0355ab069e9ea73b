#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include "scene/solids.h"

#include <optional>
#include <vector>

namespace patchlight {

/// The body of air that a room's faces enclose, whichever way each is turned.
class RoomBody {
 public:
  explicit RoomBody(const std::vector<std::vector<Point>>& faces);
  /// True inside: two of three rays from there cross the faces an odd number of times. O(n) for n corners.
  bool holds(const Point& point) const;
  /// How far from its walls a point is to be for rounding not to matter, meters.
  double step() const;

 private:
  std::vector<std::vector<Point>> faces_;
  Box box_;
};

/// The window area of each room of the scene, m^2. It counts clear faces, both sides of each pane, that have the room
/// before or behind them and no room on their other side. The distance is at most half a meter, as panes may stand in
/// the middle of a thick wall. O(openings x corners of the rooms).
std::vector<double> window_areas(const Scene& scene);

/// The closed solid without clear faces and sheets that holds all of a scene, if there is one: no daylight gets into
/// it. The far_polygons() do not count. One point of each other shell is tested, of
/// so many, spread evenly, as take 1e7 tests of a triangle, half a second, and of 16 at least. O(n log n) for n
/// corners, expected, and these tests for each closed solid as large as the scene.
std::optional<Solid> sealed_hull(const Scene& scene);

/// True when a sealed hull is that of a room, not of a body that is seen from outside: its fronts face inside,
/// something stands in it, or the scene names its rooms.
bool is_room(const Scene& scene, const Solid& hull);

/// A place for a lamp in a room: a tenth of its height under its top, over its middle. If that lies outside, it is the
/// same distance under the largest triangle of its ceiling with space below. Empty if there is none. The search tests
/// the largest triangles first, up to 1e7 tests of a triangle, and at least 16. O(n log n) for n triangles of the room.
std::optional<Point> place_under_ceiling(const Scene& scene, const Solid& room);

}  // namespace patchlight
