#pragma once

#include "patchlight/base/geometry.h"

#include <span>

namespace patchlight {

/// Unoccluded form factor from a differential area at `point` with unit `normal` to a planar polygon, in [0, 1]; the
/// part of the polygon below the point's horizon is left out. 0 when the point is behind the polygon's front side, from
/// which its corners run counter-clockwise. Lambert 1760; docs/theory/unoccluded-form-factors.md.
double point_to_polygon(const Point& point, const Vector& normal, std::span<const Point> polygon);

}  // namespace patchlight
