#pragma once

#include "patchlight/base/geometry.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// An outline with openings cut out of it.
struct CutOutline {
  std::vector<Point> corners;  ///< with seams to the openings within; empty when these take all of it
  std::size_t uncut = 0;       ///< openings that are neither within the outline nor along its edges
};

/// The plane outline without its openings, in either direction each, which lie in its plane but for little. Those along
/// its edges, as doors, become notches, those within are joined by seams. What is within `tolerance` of an edge is on
/// it.
CutOutline without_openings(const std::vector<Point>& outline, const std::vector<std::vector<Point>>& openings,
                            double tolerance);

/// The outline with rings as holes in it, joined by seams; empty where they cannot be joined.
std::vector<Point> joined_outline(const std::vector<std::vector<Point>>& rings);

}  // namespace patchlight
