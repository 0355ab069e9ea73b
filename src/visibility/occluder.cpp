#include "visibility/occluder.h"

#include "base/sampling.h"
#include "scene/extent.h"
#include "scene/triangulate.h"
#include "visibility/flat_polygon.h"
#include "visibility/hit_filter.h"
#include "visibility/walk.h"

#include <algorithm>
#include <cassert>
#include <embree3/rtcore.h>
#include <limits>
#include <mutex>
#include <new>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// All polygons of a scene, for tracing, in a scene of about unit size.
struct TracedFaces {
  RTCDevice device = rtcNewDevice(nullptr);
  Point centre;
  double scale;  // 1 / extent, 1/m
  TriangleScene triangles;
  CoveredPlaces covered_places;

  TracedFaces(const Scene& scene, const std::vector<std::uint8_t>& without, Coverings coverings);
  ~TracedFaces() { rtcReleaseDevice(device); }
  TracedFaces(const TracedFaces&) = delete;
  TracedFaces& operator=(const TracedFaces&) = delete;

  Point recentred(const Point& point) const { return scale * (point - centre); }
  // The triangles of all polygons but those marked, each hit of which the filter looks at.
  void build(TriangleScene& target, const Scene& scene, const std::vector<std::uint8_t>& without,
             RTCFilterFunctionN filter = keep_separating_hits) const;
};

void fail_on_error(void*, RTCError code, const char* message) {
  if (code == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error(std::string("Embree: ") + message);
}

TracedFaces::TracedFaces(const Scene& scene, const std::vector<std::uint8_t>& without, Coverings coverings) {
  // The memory may not do for its threads.
  if (device == nullptr) throw std::bad_alloc();
  rtcSetDeviceErrorFunction(device, fail_on_error, nullptr);
  const Box box = main_bounds(scene);
  centre = box.center();
  scale = 1 / box.diagonal().norm();
  build(triangles, scene, without);
  covered_places.coverings = std::move(coverings);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    std::vector<Point> points = corner_points(scene, p);
    for (Point& point : points) point = recentred(point);
    covered_places.add(points);
  }
}

void TracedFaces::build(TriangleScene& target, const Scene& scene, const std::vector<std::uint8_t>& without,
                        RTCFilterFunctionN filter) const {
  std::vector<Eigen::Vector3f> corners;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (without[p]) continue;
    std::vector<Point> points = corner_points(scene, p);
    for (Point& point : points) point = recentred(point);
    for (const auto& [a, b, c] : triangulate(points)) {
      for (const std::uint32_t corner : {a, b, c}) corners.push_back(points[corner].cast<float>());
      const Vector normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
      target.planes.push_back({normal, normal.dot(points[a]), p});
      target.polygons.push_back(p);
    }
  }
  target.scene = rtcNewScene(device);
  // Robust: rays do not slip between two triangles that share an edge.
  rtcSetSceneFlags(target.scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(target.scene, RTC_BUILD_QUALITY_HIGH);
  if (!target.planes.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), corners.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), target.planes.size()));
    if (vertices == nullptr || indices == nullptr) throw std::bad_alloc();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      for (int d = 0; d < 3; ++d) vertices[3 * k + static_cast<std::size_t>(d)] = corners[k][d];
      indices[k] = static_cast<unsigned>(k);
    }
    rtcSetGeometryUserData(geometry, &target);
    rtcSetGeometryOccludedFilterFunction(geometry, filter);
    rtcSetGeometryIntersectFilterFunction(geometry, filter);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(target.scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(target.scene);
}

// True if both opaque and clear polygons block.
bool has_both_kinds(Occluder::Blockers which) {
  return which != Occluder::Blockers::opaque && which != Occluder::Blockers::clear;
}

// Leaves out all clear polygons as well, or all opaque ones.
std::vector<std::uint8_t> without_kind(std::vector<std::uint8_t> left_out, const Scene& scene, bool clear) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    if (is_opening(scene, p) == clear) left_out[p] = 1;
  return left_out;
}

// The polygons that cannot stand in the way of a segment.
std::vector<std::uint8_t> left_out_by(Occluder::Blockers which, const Scene& scene) {
  if (which == Occluder::Blockers::inside_hull) return on_convex_hull(scene);
  std::vector<std::uint8_t> left_out(scene.polygons.size(), which == Occluder::Blockers::none ? 1 : 0);
  return has_both_kinds(which) ? left_out : without_kind(left_out, scene, which == Occluder::Blockers::opaque);
}

// The polygons that rays ignore: those of the other kind, if only one kind is requested.
std::vector<std::uint8_t> never_met(Occluder::Blockers which, const Scene& scene) {
  return left_out_by(has_both_kinds(which) ? Occluder::Blockers::all : which, scene);
}

RTCIntersectContext new_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return context;
}

// The context of a packet, whose rays are coherent.
Context context_of(const ShadowPacket& packet, Crossed* crossed = nullptr) {
  Context context{new_context(), nullptr, &packet, nullptr, crossed};
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

// Embree's query for one ray, in recentered coordinates.
RTCRayHit new_query(const Point& from, const Vector& toward, float farthest) {
  const Eigen::Vector3f o = from.cast<float>();
  const Eigen::Vector3f d = toward.cast<float>();
  RTCRayHit query{};
  query.ray = {o.x(), o.y(), o.z(), 0, d.x(), d.y(), d.z(), 0, farthest, ~0U, 0, 0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

// Embree's traversal is undefined for rays with infinite numbers. They come from a defect: an assertion finds it, and
// in a release they count as blocked.
bool is_finite(const RTCRay16& rays, unsigned k) {
  const float sum = rays.org_x[k] + rays.org_y[k] + rays.org_z[k] + rays.dir_x[k] + rays.dir_y[k] + rays.dir_z[k];
  const bool finite = sum - sum == 0;  // unless it is infinite or not a number
  assert(finite);
  return finite;
}

// A ray with a covered end need not be traced; it would hit all polygons in that plane.
bool covers_end(const CoveredPlaces& places, const Segment& ray) {
  return places.any() && places.covers_end(ray.from, ray.to, ray.from_polygon, ray.to_polygon);
}

// Whether bit k is set.
bool has_bit(unsigned bits, unsigned k) { return (bits >> k & 1) != 0; }

}  // namespace

struct Occluder::Tracer {
  std::shared_ptr<const TracedFaces> faces;
  const TriangleScene* blockers = nullptr;  // those that can block a segment
  TriangleScene own_blockers;               // unless these are all faces
  TriangleScene panes;                      // those that can weaken it
  SurfaceOptics specular;                   // where light is let through, or goes on as from a mirror
  std::vector<std::uint8_t> left_out;
  ShaftCuller shafts;

  Tracer(const Scene& scene, Blockers blockers, std::shared_ptr<const TracedFaces> met, SurfaceOptics of_scene);

  Point recentred(const Point& point) const { return faces->recentred(point); }
  float arriving_along(const Segment& ray, Crossed crossed) const;
  std::array<Crossed, ShadowPacket::size> crossed_by(const ShadowPacket& packet, unsigned blocked) const;
  std::optional<PolygonIndex> first_polygon(const Point& from, const Point& to) const;
  bool has_opening(PolygonIndex polygon) const;
  Hit hit_at(const Ray& ray, const TrianglePlane& plane, float found) const;
  void trace_packet(std::span<const Segment> segments, float* arriving) const;
};

Occluder::Tracer::Tracer(const Scene& scene, Blockers which, std::shared_ptr<const TracedFaces> met,
                         SurfaceOptics of_scene)
    : faces(std::move(met)),
      blockers(&faces->triangles),
      specular(std::move(of_scene)),
      left_out(left_out_by(which, scene)),
      shafts(scene, left_out) {
  const std::vector<std::uint8_t> not_blocking = specular.empty() ? left_out : without_kind(left_out, scene, true);
  if (not_blocking != never_met(which, scene)) {
    faces->build(own_blockers, scene, not_blocking);
    blockers = &own_blockers;
  }
  if (!specular.empty()) faces->build(panes, scene, without_kind(left_out, scene, false), list_crossed);
}

// The product over the polygons in their order in the scene: the same bits in whichever order they were met.
float Occluder::Tracer::arriving_along(const Segment& ray, Crossed crossed) const {
  std::ranges::sort(crossed.all());
  const Vector direction = (ray.to - ray.from).normalized();
  double share = specular.nonspecular_profile(ray.from_polygon, direction) *
                 specular.nonspecular_profile(ray.to_polygon, direction);
  for (const PolygonIndex polygon : crossed.all()) share *= specular.transmittance(polygon, direction);
  return static_cast<float>(share);
}

// The share that arrives along each segment: 0 for one that is blocked, else the product of the shares on its way.
void Occluder::Tracer::trace_packet(std::span<const Segment> segments, float* arriving) const {
  const CoveredPlaces& covered_places = faces->covered_places;
  alignas(64) RTCRay16 rays = new_rays();
  alignas(64) int valid[ShadowPacket::size];
  Segment exact[ShadowPacket::size];
  for (unsigned k = 0; k < ShadowPacket::size; ++k) {
    // Lanes beyond the last segment repeat it, so that every field of every ray is set.
    const Segment& segment = segments[std::min<std::size_t>(k, segments.size() - 1)];
    exact[k] = {recentred(segment.from), recentred(segment.to), segment.from_polygon, segment.to_polygon};
    const Eigen::Vector3f origin = exact[k].from.cast<float>();
    const Eigen::Vector3f direction = (exact[k].to - exact[k].from).cast<float>();
    rays.org_x[k] = origin.x();
    rays.org_y[k] = origin.y();
    rays.org_z[k] = origin.z();
    rays.dir_x[k] = direction.x();
    rays.dir_y[k] = direction.y();
    rays.dir_z[k] = direction.z();
    const bool covered = covers_end(covered_places, exact[k]);
    valid[k] = k < segments.size() && !covered && is_finite(rays, k) ? -1 : 0;
  }
  Context context{new_context(), exact, nullptr, covered_places.any() ? &covered_places : nullptr};
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, blockers->scene, &context.embree, &rays);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const bool blocked = valid[k] == 0 || rays.tfar[k] < 0;
    arriving[k] = blocked ? 0.0F : 1.0F;
    valid[k] = blocked ? 0 : -1;
  }
  if (specular.empty()) return;
  std::array<Crossed, ShadowPacket::size> crossed;
  context.crossed = crossed.data();
  context.covered_places = nullptr;
  if (!panes.planes.empty()) rtcOccluded16(valid, panes.scene, &context.embree, &rays);
  for (std::size_t k = 0; k < segments.size(); ++k)
    if (valid[k] != 0) arriving[k] = arriving_along(exact[k], crossed[k]);
}

std::uint16_t Occluder::occluded(const ShadowPacket& packet) const {
  alignas(64) RTCRay16 rays = rays_of(packet);
  alignas(64) int valid[ShadowPacket::size];
  unsigned blocked = 0;
  for (unsigned k = 0; k < ShadowPacket::size; ++k) {
    const bool is_blocked = covers_end(tracer_->faces->covered_places, exact_ray(packet, k)) || !is_finite(rays, k);
    blocked |= static_cast<unsigned>(is_blocked) << k;
    valid[k] = is_blocked ? 0 : -1;
  }
  Context context = context_of(packet);
  rtcOccluded16(valid, tracer_->blockers->scene, &context.embree, &rays);
  for (unsigned k = 0; k < ShadowPacket::size; ++k) blocked |= static_cast<unsigned>(rays.tfar[k] < 0) << k;
  return static_cast<std::uint16_t>(blocked);
}

// The polygons crossed by the rays whose bit in `blocked` is not set.
std::array<Crossed, ShadowPacket::size> Occluder::Tracer::crossed_by(const ShadowPacket& packet,
                                                                     unsigned blocked) const {
  alignas(64) RTCRay16 rays = rays_of(packet);
  alignas(64) int valid[ShadowPacket::size];
  for (unsigned k = 0; k < ShadowPacket::size; ++k) valid[k] = has_bit(blocked, k) ? 0 : -1;
  std::array<Crossed, ShadowPacket::size> crossed;
  Context context = context_of(packet, crossed.data());
  if (!panes.planes.empty()) rtcOccluded16(valid, panes.scene, &context.embree, &rays);
  return crossed;
}

std::array<float, ShadowPacket::size> Occluder::transmittance(const ShadowPacket& packet) const {
  const unsigned blocked = occluded(packet);
  std::array<float, ShadowPacket::size> arriving{};
  for (unsigned k = 0; k < ShadowPacket::size; ++k) arriving[k] = has_bit(blocked, k) ? 0.0F : 1.0F;
  if (tracer_->specular.empty()) return arriving;
  const std::array<Crossed, ShadowPacket::size> crossed = tracer_->crossed_by(packet, blocked);
  for (unsigned k = 0; k < ShadowPacket::size; ++k)
    if (arriving[k] > 0) arriving[k] = tracer_->arriving_along(exact_ray(packet, k), crossed[k]);
  return arriving;
}

std::array<std::optional<std::vector<PolygonIndex>>, ShadowPacket::size> Occluder::crossings(
    const ShadowPacket& packet) const {
  const unsigned blocked = occluded(packet);
  std::array<Crossed, ShadowPacket::size> crossed = tracer_->crossed_by(packet, blocked);
  std::array<std::optional<std::vector<PolygonIndex>>, ShadowPacket::size> found;
  for (unsigned k = 0; k < ShadowPacket::size; ++k) {
    if (has_bit(blocked, k)) continue;
    const std::span<PolygonIndex> polygons = crossed[k].all();
    found[k].emplace(polygons.begin(), polygons.end());
    std::sort(found[k]->begin(), found[k]->end());
  }
  return found;
}

// The first polygon that can block between two points, in recentred coordinates.
std::optional<PolygonIndex> Occluder::Tracer::first_polygon(const Point& from, const Point& to) const {
  RTCRayHit query = new_query(from, to - from, 1);
  const Segment exact{from, to, no_polygon, no_polygon};
  Context context{new_context(), &exact, nullptr, nullptr};
  rtcIntersect1(blockers->scene, &context.embree, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return blockers->planes[query.hit.primID].polygon;
}

// A polygon that blocks nothing lies over a part of this one.
bool Occluder::Tracer::has_opening(PolygonIndex polygon) const {
  const auto blocks_nothing = [&](PolygonIndex p) { return left_out[p] != 0 || specular.is_clear(p); };
  return std::ranges::any_of(std::array{Side::front, Side::back}, [&](Side side) {
    return std::ranges::any_of(faces->covered_places.coverings.over_side(polygon, side), blocks_nothing);
  });
}

bool Occluder::hides(std::span<const Point> first, std::span<const Point> second,
                     std::span<const PolygonIndex> own) const {
  std::vector<Point> from;
  std::vector<Point> to;
  for (const Point& point : first) from.push_back(tracer_->recentred(point));
  for (const Point& point : second) to.push_back(tracer_->recentred(point));
  const auto middle = [](const std::vector<Point>& points) {
    return Point(std::accumulate(points.begin(), points.end(), Point(Point::Zero())) /
                 static_cast<double>(points.size()));
  };
  const auto cuts = [&](const std::optional<PolygonIndex>& polygon) {
    return polygon && std::find(own.begin(), own.end(), *polygon) == own.end() && !tracer_->has_opening(*polygon) &&
           cuts_all(tracer_->faces->covered_places.polygons[*polygon], from, to, in_plane_tolerance);
  };
  const auto met = tracer_->first_polygon(middle(from), middle(to));
  return met && (cuts(met) || cuts(tracer_->first_polygon(middle(to), middle(from))));
}

const ShaftCuller& Occluder::shafts() const { return tracer_->shafts; }

TracingFrame Occluder::frame() const { return {tracer_->faces->centre, tracer_->faces->scale}; }

Occluder::Occluder(const Scene& scene, Blockers blockers, Coverings coverings, Reflections reflections)
    : tracer_(std::make_unique<Tracer>(
          scene, blockers, std::make_shared<const TracedFaces>(scene, never_met(blockers, scene), std::move(coverings)),
          has_both_kinds(blockers) ? SurfaceOptics(scene, reflections) : SurfaceOptics())) {}

Occluder::Occluder(const Scene& scene, Blockers blockers, const Occluder& like)
    : tracer_(std::make_unique<Tracer>(scene, blockers, like.tracer_->faces, like.tracer_->specular)) {
  assert(has_both_kinds(blockers));
}
Occluder::~Occluder() = default;
Occluder::Occluder(Occluder&&) noexcept = default;
Occluder& Occluder::operator=(Occluder&&) noexcept = default;

bool Occluder::can_occlude() const {
  return !tracer_->blockers->planes.empty() || !tracer_->specular.empty() || tracer_->faces->covered_places.any();
}

const SurfaceOptics& Occluder::optics() const { return tracer_->specular; }

bool Occluder::is_covered(PolygonIndex polygon, Side side, const Point& place) const {
  return tracer_->faces->covered_places.covers(polygon, side, tracer_->recentred(place));
}

bool Occluder::lies_over(PolygonIndex upper, PolygonIndex polygon, Side side) const {
  return tracer_->faces->covered_places.coverings.lies_over(upper, polygon, side);
}

bool Occluder::is_covered_in_part(PolygonIndex polygon, Side side) const {
  return !tracer_->faces->covered_places.coverings.over_side(polygon, side).empty();
}

std::vector<float> Occluder::transmittance(std::span<const Segment> segments) const {
  std::vector<float> arriving(segments.size(), 1);
  if (!can_occlude()) return arriving;
  for (std::size_t k = 0; k < segments.size(); k += ShadowPacket::size) {
    const std::size_t count = std::min<std::size_t>(ShadowPacket::size, segments.size() - k);
    tracer_->trace_packet(segments.subspan(k, count), arriving.data() + k);
  }
  return arriving;
}

std::vector<std::uint8_t> Occluder::occluded(std::span<const Segment> segments) const {
  std::vector<std::uint8_t> blocked;
  blocked.reserve(segments.size());
  for (const float share : transmittance(segments)) blocked.push_back(share > 0 ? 0 : 1);
  return blocked;
}

// The hit in double: where the ray meets the triangle's plane, unless it grazes.
Hit Occluder::Tracer::hit_at(const Ray& ray, const TrianglePlane& plane, float found) const {
  const double cosine = plane.normal.dot(ray.direction);
  const bool grazes = std::abs(cosine) < 1e-3;
  const double distance =
      (grazes ? static_cast<double>(found) : -plane.height(recentred(ray.origin)) / cosine) / faces->scale;
  return {plane.polygon, cosine < 0 ? Side::front : Side::back, ray.origin + distance * ray.direction, distance,
          ray.direction};
}

std::vector<std::optional<Hit>> Occluder::first_hits(std::span<const Ray> rays) const {
  struct Found {
    unsigned triangle = RTC_INVALID_GEOMETRY_ID;
    float distance = 0;
  };
  const TriangleScene& triangles = tracer_->faces->triangles;
  const CoveredPlaces& covered_places = tracer_->faces->covered_places;
  // 1. All rays. The planes that they meet are on their way from memory meanwhile.
  std::vector<Found> found(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Ray& ray = rays[k];
    assert(ray.origin.allFinite() && ray.direction.allFinite());
    if (ray.direction.isZero(0) || !ray.origin.allFinite() || !ray.direction.allFinite()) continue;
    const Point start = tracer_->recentred(ray.origin);
    RTCRayHit query = new_query(start, ray.direction, std::numeric_limits<float>::infinity());
    // The scene has unit extent: nothing lies so far along a ray. Origins may lie outside.
    const Segment exact{start, start + 1e6 * ray.direction, ray.from_polygon, no_polygon};
    Context context{new_context(), &exact, nullptr, covered_places.any() ? &covered_places : nullptr};
    context.is_endless = true;
    rtcIntersect1(triangles.scene, &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    found[k] = {query.hit.primID, query.ray.tfar};
    __builtin_prefetch(&triangles.planes[query.hit.primID]);
  }

  // 2. Where they meet it.
  std::vector<std::optional<Hit>> hits(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (found[k].triangle != RTC_INVALID_GEOMETRY_ID)
      hits[k] = tracer_->hit_at(rays[k], triangles.planes[found[k].triangle], found[k].distance);
  }
  return hits;
}

// At each specular polygon a ray continues with the probability of its transmittance or reflectance.
std::vector<std::optional<Hit>> Occluder::sample_nonspecular_hits(std::span<const Ray> rays, std::uint64_t seed,
                                                                  std::span<const std::size_t> keys) const {
  assert(keys.empty() || keys.size() == rays.size());
  std::vector<std::optional<Hit>> hits = first_hits(rays);
  const SurfaceOptics& optics = tracer_->specular;
  if (optics.empty()) return hits;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const std::size_t key = keys.empty() ? k : keys[k];
    const auto draw = [&](const Hit& hit, std::uint64_t meeting) -> std::optional<Vector> {
      const double drawn = hash({seed, key, meeting}) * 0x1p-32;
      const double passing = optics.transmittance(hit.polygon, hit.direction);
      if (drawn < passing) return hit.direction;
      if (drawn >= passing + optics.reflectance(hit.polygon, hit.direction)) return {};
      return optics.mirrored(hit.polygon, hit.direction);
    };
    hits[k] = follow_path(*this, hits[k], draw);
  }
  return hits;
}

namespace {

bool has_any(const Scene& scene, const auto& is_such) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    if (is_such(p)) return true;
  return false;
}

bool has_openings(const Scene& scene) {
  return has_any(scene, [&](PolygonIndex p) { return is_opening(scene, p); });
}

bool has_mirrors(const Scene& scene) {
  return has_any(scene,
                 [&](PolygonIndex p) { return is_mirror(scene, p, Side::front) || is_mirror(scene, p, Side::back); });
}

}  // namespace

// The occluders that are built on first use.
struct Tracing::Later {
  std::once_flag all_once, opaque_once, clear_once;
  std::shared_ptr<const Occluder> all, opaque, clear;
};

Tracing::Tracing(const Scene& scene, Coverings coverings, Occluder::Blockers between_patches, Reflections reflections)
    : scene_(scene),
      coverings_(std::move(coverings)),
      kind_(between_patches),
      has_openings_(has_openings(scene)),
      has_specular_surfaces_(has_openings_ || has_mirrors(scene)),
      reflections_(reflections),
      between_patches_(std::make_shared<const Occluder>(scene, between_patches, coverings_, reflections)),
      later_(std::make_unique<Later>()) {}

Tracing::~Tracing() = default;

const Occluder& Tracing::all_faces() const {
  std::call_once(later_->all_once, [&] {
    const auto all = Occluder::Blockers::all;
    later_->all = kind_ == all ? between_patches_ : std::make_shared<const Occluder>(scene_, all, *between_patches_);
  });
  return *later_->all;
}

std::shared_ptr<const Occluder> Tracing::opaque_faces() const {
  std::call_once(later_->opaque_once, [&] {
    if (has_openings_) {
      later_->opaque = std::make_shared<const Occluder>(scene_, Occluder::Blockers::opaque, coverings_);
    } else {
      all_faces();
      later_->opaque = later_->all;
    }
  });
  return later_->opaque;
}

std::shared_ptr<const Occluder> Tracing::clear_faces() const {
  if (!has_openings_) return nullptr;
  std::call_once(later_->clear_once,
                 [&] { later_->clear = std::make_shared<const Occluder>(scene_, Occluder::Blockers::clear); });
  return later_->clear;
}

}  // namespace patchlight
