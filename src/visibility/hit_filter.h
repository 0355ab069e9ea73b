#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/base/large_array.h"
#include "patchlight/scene/scene.h"

#include "visibility/flat_polygon.h"
#include "visibility/occluder.h"

#include <array>
#include <cstddef>
#include <embree3/rtcore.h>
#include <span>

namespace patchlight {

/// The plane of one triangle, in recentered coordinates, with the polygon that the triangle belongs to.
struct TrianglePlane {
  Vector normal;
  double offset = 0;
  PolygonIndex polygon = no_polygon;

  double height(const Point& point) const { return normal.dot(point) - offset; }
};

/// The triangles of some polygons, ready to be traced: the user data of their geometry.
struct TriangleScene {
  RTCScene scene = nullptr;
  LargeArray<TrianglePlane> planes;   ///< per triangle
  LargeArray<PolygonIndex> polygons;  ///< per triangle, contiguous: filters read mostly these

  TriangleScene() = default;
  TriangleScene(const TriangleScene&) = delete;
  TriangleScene& operator=(const TriangleScene&) = delete;
  ~TriangleScene() {
    if (scene) rtcReleaseScene(scene);
  }
};

/// Sixteen rays from 0 to 1 as Embree takes them, of which origins and directions are still to be set.
RTCRay16 new_rays();

/// The rays of a packet as Embree takes them.
RTCRay16 rays_of(const ShadowPacket& packet);

/// Ray k of a packet, in double precision.
Segment exact_ray(const ShadowPacket& rays, std::size_t k);

/// The clear polygons that one ray crosses.
struct Crossed {
  std::array<PolygonIndex, Occluder::most_meetings> polygons;
  std::size_t count = 0;

  std::span<PolygonIndex> all() { return std::span(polygons).first(count); }
};

/// The filter's data beside Embree's own context.
struct Context {
  RTCIntersectContext embree;                     ///< first, so that a pointer to it is a pointer to the whole
  const Segment* rays = nullptr;                  ///< recentered; they decide whether a hit in single precision counts
  const ShadowPacket* packet = nullptr;           ///< in place of rays
  const CoveredPlaces* covered_places = nullptr;  ///< hits on these do not count, if given
  Crossed* crossed = nullptr;                     ///< per ray: the result of list_crossed()
  bool is_endless = false;                        ///< whether the ray, a single one, is endless
};

/// Embree's filter: rejects hits on polygons whose plane does not separate the two ends of the ray, and on polygons
/// that the ray starts or ends on.
void keep_separating_hits(const RTCFilterFunctionNArguments* arguments);

/// Embree's filter for clear polygons: lists each polygon whose plane separates the two ends of the ray once, and
/// rejects the hit, so that the ray continues.
void list_crossed(const RTCFilterFunctionNArguments* arguments);

}  // namespace patchlight
