#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace patchlight {

/// A line on a polygon along which another face touches it, crosses it, or ends close before it. The light on the
/// polygon changes abruptly there.
struct ContactLine {
  Point from;      ///< in the polygon's plane, meters
  Point to;        ///< likewise
  double gap = 0;  ///< the largest distance of the other face from the line, meters; 0 where it touches or crosses
};

/// The lines of contact of a scene, and the resolution at which patches follow them.
struct ContactLines {
  std::vector<std::vector<ContactLine>> on;  ///< at the index of each polygon; empty: there are none
  bool everywhere = false;                   ///< faces cross so often that the search was skipped
  double size = 0;                           ///< the root of the area of all faces, meters
  /// Meters. Patches with longer edges follow the lines at this resolution.
  double detail = std::numeric_limits<double>::infinity();
  double of_edge = 1;  ///< patches follow the lines as those with this part of their edges do: a half where they will
                       ///< be cut in four
};

/// The number of lines on all polygons.
std::size_t number_of(const ContactLines& contacts);

/// The lines of contact on every polygon with a kept side, without those bent by rounding. Faces touch if they are
/// within weld_distance(). Edges close before a polygon count up to a fiftieth of the root of the area of all faces,
/// and a tenth of that of the polygon. They count only where the face before the polygon ends, not where it continues;
/// such an edge is a line of its own face too. Lines may reach beyond a polygon that is not convex, may cross and may
/// be duplicate. Returns none, with `everywhere` set, if about 500 polygons show that there are over two million, e.g.
/// in a damaged model. O(n log n + k) for n polygons of which k pairs are near each other.
ContactLines find_contact_lines(const Scene& scene, const KeptSides& kept);

}  // namespace patchlight
