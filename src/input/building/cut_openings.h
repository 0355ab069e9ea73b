#pragma once

#include "patchlight/scene/scene.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// An outline with openings cut out of it.
struct CutOutline {
  std::vector<std::vector<Point>> parts;  ///< simple polygons without holes; empty when the openings cover the outline
  std::size_t beyond = 0;                 ///< number of openings that extend beyond the outline
  bool is_cut = true;                     ///< false when no area can be computed and the outline stays whole
};

/// Accuracy of building drawings, meters.
inline constexpr double drawing_tolerance = 1e-3;

/// The plane outline minus its openings. Openings may have either orientation, overlap, and touch each other or the
/// outline. They are projected into its plane. Corners within `tolerance` of an edge of the outline are snapped to it.
/// The parts keep the orientation of the outline and all corners bit by bit, and share their edges. Without openings
/// the outline is the only part. Cost: O(n log n) for n corners, plus corners of the outline times corners of the
/// openings.
CutOutline without_openings(const std::vector<Point>& outline, const std::vector<std::vector<Point>>& openings,
                            double tolerance);

/// Adds a polygon like this one for each part, with its own corners.
Scene with_parts(Scene scene, Polygon polygon, const std::vector<std::vector<Point>>& parts);

}  // namespace patchlight
