#pragma once

#include "patchlight/base/geometry.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Triangles (indices into `polygon`) that cover a simple planar polygon, convex or not, with its orientation; n - 2 of
/// them for n corners. Convex quadrilaterals are cut along their shorter diagonal. O(n log n) for n corners of
/// most outlines, O(n^2) in the worst case.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Point> polygon);

/// The same as points.
std::vector<std::array<Point, 3>> triangles_of(std::span<const Point> polygon);

/// True when no corner of the planar polygon turns inward.
bool is_convex(std::span<const Point> polygon);

}  // namespace patchlight
