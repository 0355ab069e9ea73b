#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// A polygon as points are held against it.
struct Facet {
  std::vector<Point> corners;
  Vector normal;    ///< unit, of its front
  double size = 0;  ///< metres, the diagonal of its bounds

  /// Metres before its front.
  double height(const Point& point) const { return normal.dot(point - corners[0]); }
};

std::vector<Facet> facets_of(const Scene& scene);

/// True when the point is no farther than `tolerance`, in metres, from the polygon.
bool lies_on(const Point& point, const Facet& facet, double tolerance);

}  // namespace patchlight
