#pragma once

#include "scene/coverings.h"
#include "visibility/flat_polygon.h"

#include <vector>

namespace patchlight {

/// Tells the places of polygons over which another polygon lies, in recentred coordinates.
struct CoveredPlaces {
  Coverings coverings;
  std::vector<FlatPolygon> polygons;  ///< of the scene

  bool any() const { return !coverings.over.empty(); }

  bool covers(PolygonIndex polygon, Side side, const Point& place) const;

  /// True if one of two polygons lies over the other in one plane, but for rounding. O(log n) for n polygons over one.
  bool lie_in_one_plane(PolygonIndex a, PolygonIndex b) const;

  /// True when one end of a segment lies on a covered place of the polygon there, on the side that the segment sees.
  bool covers_end(const Point& from, const Point& to, PolygonIndex from_polygon, PolygonIndex to_polygon) const;
};

}  // namespace patchlight
