#include "visibility/hit_filter.h"

#include "base/target_clones.h"
#include "base/tolerances.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// Between faces that lie one over the other the order is known, and rounding does not decide on it: a ray that starts
// on one of them is not blocked by the other, which may lie before it by in_plane_tolerance.
double tolerance_for(const TrianglePlane& plane, const Segment& ray, const CoveredPlaces* places) {
  const bool is_together = places != nullptr && (places->lie_in_one_plane(plane.polygon, ray.from_polygon) ||
                                                 places->lie_in_one_plane(plane.polygon, ray.to_polygon));
  return is_together ? in_plane_tolerance : tolerance_of_shapes;
}

// A polygon blocks a ray only if the ray neither starts nor ends on it and its plane separates the two ends of the ray.
// So hits near an end, where single precision is too coarse, are decided in double precision.
bool separates(const TrianglePlane& plane, const Segment& ray, double tolerance) {
  if (plane.polygon == ray.from_polygon || plane.polygon == ray.to_polygon) return false;
  const double from = plane.height(ray.from);
  const double to = plane.height(ray.to);
  return (from > tolerance && to < -tolerance) || (from < -tolerance && to > tolerance);
}

// Marks the hits that single precision decides: the distances of the ray's ends from the triangle's plane, t |n . d|
// and (1 - t) |n . d|, are large enough. An endless ray has no end on the far side.
template <unsigned N>
PATCHLIGHT_INLINE void mark_clear_hits(const RTCFilterFunctionNArguments& hits, bool is_endless, unsigned char* clear) {
  for (unsigned k = 0; k < N; ++k) {
    const float x = RTCHitN_Ng_x(hits.hit, N, k);
    const float y = RTCHitN_Ng_y(hits.hit, N, k);
    const float z = RTCHitN_Ng_z(hits.hit, N, k);
    const float t = RTCRayN_tfar(hits.ray, N, k);
    const float nearer = is_endless ? t : std::min(t, 1 - t);
    const float height = nearer * (x * RTCRayN_dir_x(hits.ray, N, k) + y * RTCRayN_dir_y(hits.ray, N, k) +
                                   z * RTCRayN_dir_z(hits.ray, N, k));
    // Single precision is coarser far from the scene's center.
    const float far = std::max({1.0F, std::abs(RTCRayN_org_x(hits.ray, N, k)), std::abs(RTCRayN_org_y(hits.ray, N, k)),
                                std::abs(RTCRayN_org_z(hits.ray, N, k))});
    const float least = 1e-4F * 1e-4F * far * far * (x * x + y * y + z * z);
    clear[k] = static_cast<unsigned char>(static_cast<int>(height * height > least) & static_cast<int>(nearer > 0));
  }
}

// Whether another polygon lies over the point where the ray hits the plane.
bool is_covered(const TrianglePlane& plane, const Segment& ray, const CoveredPlaces& places) {
  const double from = plane.height(ray.from);
  const Side side = from > 0 ? Side::front : Side::back;
  if (places.coverings.over_side(plane.polygon, side).empty()) return false;
  const double to = plane.height(ray.to);
  return places.covers(plane.polygon, side, ray.from + from / (from - to) * (ray.to - ray.from));
}

}  // namespace

RTCRay16 new_rays() {
  RTCRay16 rays;
  for (unsigned k = 0; k < ShadowPacket::size; ++k) {
    rays.tnear[k] = 0;
    rays.tfar[k] = 1;
    rays.time[k] = 0;
    rays.mask[k] = ~0U;
    rays.id[k] = k;
    rays.flags[k] = 0;
  }
  return rays;
}

RTCRay16 rays_of(const ShadowPacket& packet) {
  RTCRay16 rays = new_rays();
  std::copy(packet.from_x.begin(), packet.from_x.end(), rays.org_x);
  std::copy(packet.from_y.begin(), packet.from_y.end(), rays.org_y);
  std::copy(packet.from_z.begin(), packet.from_z.end(), rays.org_z);
  std::copy(packet.toward_x.begin(), packet.toward_x.end(), rays.dir_x);
  std::copy(packet.toward_y.begin(), packet.toward_y.end(), rays.dir_y);
  std::copy(packet.toward_z.begin(), packet.toward_z.end(), rays.dir_z);
  return rays;
}

Segment exact_ray(const ShadowPacket& rays, std::size_t k) {
  const Point from(rays.from_x[k], rays.from_y[k], rays.from_z[k]);
  const Vector toward(rays.toward_x[k], rays.toward_y[k], rays.toward_z[k]);
  return {from, from + toward, rays.from_polygon[k], rays.to_polygon[k]};
}

PATCHLIGHT_TARGET_CLONES
void keep_separating_hits(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const Context*>(arguments->context);
  const auto& triangles = *static_cast<const TriangleScene*>(arguments->geometryUserPtr);
  const ShadowPacket* const packet = context->packet;
  std::array<unsigned char, ShadowPacket::size> clear{};
  if (arguments->N == ShadowPacket::size && packet != nullptr)
    mark_clear_hits<ShadowPacket::size>(*arguments, false, clear.data());
  if (arguments->N == 1 && context->is_endless) mark_clear_hits<1>(*arguments, true, clear.data());
  for (unsigned k = 0; k < arguments->N; ++k) {
    if (arguments->valid[k] != -1) continue;
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, k);
    const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, k);
    const PolygonIndex from = packet != nullptr ? packet->from_polygon[ray] : context->rays[ray].from_polygon;
    const PolygonIndex to = packet != nullptr ? packet->to_polygon[ray] : context->rays[ray].to_polygon;
    const PolygonIndex polygon = triangles.polygons[triangle];
    bool blocks = polygon != from && polygon != to;
    if (blocks && clear[k] == 0) {
      blocks = packet != nullptr
                   ? separates(triangles.planes[triangle], exact_ray(*packet, ray), in_plane_tolerance)
                   : separates(triangles.planes[triangle], context->rays[ray],
                               tolerance_for(triangles.planes[triangle], context->rays[ray], context->covered_places));
    }
    if (!blocks || (context->covered_places != nullptr &&
                    is_covered(triangles.planes[triangle], context->rays[ray], *context->covered_places)))
      arguments->valid[k] = 0;
  }
}

void list_crossed(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const Context*>(arguments->context);
  const auto& planes = static_cast<const TriangleScene*>(arguments->geometryUserPtr)->planes;
  for (unsigned k = 0; k < arguments->N; ++k) {
    if (arguments->valid[k] != -1) continue;
    arguments->valid[k] = 0;
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, k);
    const TrianglePlane& plane = planes[RTCHitN_primID(arguments->hit, arguments->N, k)];
    const bool crosses = context->packet != nullptr
                             ? separates(plane, exact_ray(*context->packet, ray), in_plane_tolerance)
                             : separates(plane, context->rays[ray], tolerance_of_shapes);
    Crossed& crossed = context->crossed[ray];
    const std::span<PolygonIndex> listed = crossed.all();
    if (!crosses || std::find(listed.begin(), listed.end(), plane.polygon) != listed.end()) continue;
    if (crossed.count < crossed.polygons.size()) crossed.polygons[crossed.count++] = plane.polygon;
  }
}

}  // namespace patchlight
