#pragma once

#include "patchlight/scene/scene.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// Where the edges of an outline are finer than patches, patches follow fewer corners: none of the outline is farther
/// from theirs than this share of the longest patch edge, or of the narrowest face there if that is less.
inline constexpr double outline_tolerance = 0.01;

/// Whether patches could do without a corner.
struct LooseCorner {
  double width = 0;       ///< 4 area / perimeter of the narrowest face that has it, in metres; 0: the corner is kept
  bool reversed = false;  ///< the first face that has it goes through it the other way
};

/// Per polygon and corner of outline_corners(). A polygon without loose corners has an empty list; when no polygon has
/// any, there are no lists.
using LooseCorners = std::vector<std::vector<LooseCorner>>;

/// The corners of a polygon, no two consecutive ones at one place.
std::vector<Point> outline_corners(const Scene& scene, PolygonIndex polygon);

/// Loose are the corners of outlines with over 24 of them where the outline turns by at most 15 degrees and that one
/// face alone has, or two faces between the same neighbours. Positions are compared bit by bit. O(n log n).
LooseCorners find_loose_corners(const Scene& scene);

/// The corners that the patches of a polygon follow. Between two corners that are kept a run of loose ones, whose edges
/// are all shorter than `max_edge` and the face is wide, becomes a coarser one with chords that turn by at most 30
/// degrees each. Its corners are moved so that the area on either side stays the same to rounding, and they have the
/// same bits for both faces that share the run. All corners where the coarser outline would cross itself.
std::vector<Point> coarse_outline(const Scene& scene, const LooseCorners& loose, PolygonIndex polygon, double max_edge);

}  // namespace patchlight
