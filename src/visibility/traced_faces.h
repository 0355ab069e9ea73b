#pragma once

#include "patchlight/scene/scene.h"

#include "scene/coverings.h"
#include "visibility/covered_places.h"
#include "visibility/hit_filter.h"

#include <cstdint>
#include <embree3/rtcore.h>
#include <vector>

namespace patchlight {

/// All polygons of a scene, which rays meet, in a scene of about unit size.
struct TracedFaces {
  RTCDevice device = rtcNewDevice(nullptr);
  Point centre;
  double scale;  ///< 1 / extent, 1/m
  TriangleScene triangles;
  CoveredPlaces covered_places;

  TracedFaces(const Scene& scene, const std::vector<std::uint8_t>& without, Coverings coverings);
  ~TracedFaces() { rtcReleaseDevice(device); }
  TracedFaces(const TracedFaces&) = delete;
  TracedFaces& operator=(const TracedFaces&) = delete;

  Point recentred(const Point& point) const { return scale * (point - centre); }
  /// The triangles of all polygons but those marked, each hit of which the filter looks at.
  void build(TriangleScene& target, const Scene& scene, const std::vector<std::uint8_t>& without,
             RTCFilterFunctionN filter = keep_separating_hits) const;
};

}  // namespace patchlight
