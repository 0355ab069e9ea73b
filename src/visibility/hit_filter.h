#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"
#include "patchlight/visibility/occluder.h"

#include "visibility/covered_places.h"

#include <embree3/rtcore.h>

namespace patchlight {

/// The plane of one triangle, in recentred coordinates, with the polygon that the triangle belongs to.
struct Plane {
  Vector normal;
  double offset = 0;
  PolygonIndex polygon = no_polygon;

  double height(const Point& point) const { return normal.dot(point) - offset; }
};

/// One ray in double: what decides whether a hit that Embree finds in single precision is one.
struct ExactRay {
  Point from;
  Point to;  ///< or, for a ray without an end, a point far along it
  PolygonIndex from_polygon = no_polygon;
  PolygonIndex to_polygon = no_polygon;
};

/// Ray k of a packet.
ExactRay exact_ray(const ShadowPacket& rays, std::size_t k);

/// What the filter needs beside Embree's own context.
struct Context {
  RTCIntersectContext embree;  ///< first, so that a pointer to it is a pointer to the whole
  const ExactRay* rays = nullptr;
  const ShadowPacket* packet = nullptr;           ///< in place of rays
  const CoveredPlaces* covered_places = nullptr;  ///< hits on these do not count, if given
};

/// Embree's filter: drops the hits on polygons whose plane does not separate the two ends of the ray, and on those that
/// it starts or ends on. The user data of the geometry are the planes of its triangles.
void keep_separating_hits(const RTCFilterFunctionNArguments* arguments);

}  // namespace patchlight
