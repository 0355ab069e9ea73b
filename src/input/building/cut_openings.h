#pragma once

#include "patchlight/scene/scene.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// An outline with openings cut out of it.
struct CutOutline {
  std::vector<std::vector<Point>> parts;  ///< simple polygons without holes; none when the openings take all of it
  std::size_t beyond = 0;                 ///< openings that reach beyond the outline
  bool is_cut = true;                     ///< false when the outline stays whole because no area can be computed
};

/// Drawings of buildings are exact to it, meters.
inline constexpr double drawing_tolerance = 1e-3;

/// The plane outline without its openings. Openings may run in either direction, overlap, touch each other and touch
/// the outline; they are laid into its plane. A corner within `tolerance` of an edge of the outline is on it. The parts
/// turn the way of the outline, keep its corners and those of the openings bit by bit, and share their edges. Without
/// openings the outline is the only part. O(n log n) for n corners, and the outline's corners times those of the
/// openings.
CutOutline without_openings(const std::vector<Point>& outline, const std::vector<std::vector<Point>>& openings,
                            double tolerance);

/// The scene with a polygon like this one for each of the parts, with corners of its own.
Scene with_parts(Scene scene, Polygon polygon, const std::vector<std::vector<Point>>& parts);

}  // namespace patchlight
