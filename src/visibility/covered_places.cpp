#include "visibility/covered_places.h"

#include <algorithm>
#include <cmath>

namespace patchlight {

bool CoveredPlaces::covers(PolygonIndex polygon, Side side, const Point& place) const {
  const auto over = coverings.over_side(polygon, side);
  return std::any_of(over.begin(), over.end(), [&](PolygonIndex other) { return contains(polygons[other], place); });
}

bool CoveredPlaces::lie_in_one_plane(PolygonIndex a, PolygonIndex b) const {
  if (a == no_polygon || b == no_polygon) return false;
  for (const Side side : {Side::front, Side::back})
    if (coverings.lies_over(a, b, side) || coverings.lies_over(b, a, side)) return true;
  return false;
}

bool CoveredPlaces::covers_end(const Point& from, const Point& to, PolygonIndex from_polygon,
                               PolygonIndex to_polygon) const {
  const auto covers_start = [&](const Point& start, const Point& end, PolygonIndex polygon) {
    if (polygon == no_polygon) return false;
    const double rise = polygons[polygon].normal.dot(end - start);
    // Along the surface neither side is seen.
    if (std::abs(rise) <= in_plane_tolerance) return false;
    return covers(polygon, rise > 0 ? Side::front : Side::back, start);
  };
  return covers_start(from, to, from_polygon) || covers_start(to, from, to_polygon);
}

}  // namespace patchlight
