#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// Bounds of the model without what lies far from most of it: from a stray vertex a hundred kilometres away nothing is
/// learned about how large details are. The middle is the median of the corners, weighted by the area of their
/// polygons, of which none counts for more than an eighth of all; what is farther from it than 100 times the distance
/// within which three fifths of that area lie is left out, unless that is 1e12 times as large as the rest. In most
/// models that is nothing: then these are the bounds of all vertices that polygons use. O(n) for n corners, expected.
Box main_bounds(const Scene& scene);

/// The diagonal of main_bounds() in metres: what tolerances are relative to.
double extent_of(const Scene& scene);

/// How near two vertices have to be to be one, in metres: weld_distance() of the main bounds, or by tenths as much less
/// as it takes for no more than a millionth of the area, or a fifth of the faces, to be narrower than that without
/// being slivers, a hundred thousand times as long as wide. Large polygons count as in main_bounds().
double weld_distance(const Scene& scene);

/// The polygons with a corner outside of main_bounds(), in order.
std::vector<PolygonIndex> far_polygons(const Scene& scene);

}  // namespace patchlight
