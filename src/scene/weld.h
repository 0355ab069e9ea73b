#pragma once

#include "patchlight/base/geometry.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Vertices nearer than this share of the model's extent are one. Exporters write six significant digits or single
/// precision: a coordinate is then right to 5e-7 of the largest, so the same vertex written twice differs by at most
/// 1e-6. Smaller details are lost; shadow rays, traced in single precision, would hardly see them.
inline constexpr double weld_tolerance = 1e-6;

/// How near two vertices of a model with these bounds have to be to be one, in metres: weld_tolerance of the longest
/// side, or more where double precision does not resolve that, far away from the origin.
double weld_distance(const Box& bounds);

/// For every point the index of the first point that is not farther than `distance` among those that stand for
/// themselves; often its own. O(n).
std::vector<std::uint32_t> welded(std::span<const Point> points, double distance);

}  // namespace patchlight
