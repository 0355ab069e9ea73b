#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace patchlight {

/// A corner of one of several rings: the ring, and its place there.
using RingCorner = std::array<std::size_t, 2>;

/// One walk over all corners of rings in a plane: the first is an outline, the others are holes in it, in either
/// direction; the outline walks to every hole and back along a seam, the shortest that meets nothing, as polygons of a
/// scene do. Nothing where there is no such seam, a ring has fewer than three corners, or all have more than 2,000.
/// Takes the square of the number of corners.
std::optional<std::vector<RingCorner>> joined_rings(const std::vector<std::vector<Eigen::Vector2d>>& rings);

}  // namespace patchlight
