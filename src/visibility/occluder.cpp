#include "patchlight/visibility/occluder.h"

#include "patchlight/scene/triangulate.h"
#include "patchlight/visibility/convex_hull.h"

#include <algorithm>
#include <cassert>
#include <embree3/rtcore.h>
#include <limits>
#include <stdexcept>
#include <string>

namespace patchlight {
namespace {

// A point nearer to a plane than this share of the scene's extent lies on it.
constexpr double on_plane_tolerance = 1e-9;

// Rays are traced in a scene of unit extent: so far along a ray lies nothing any more. Origins may lie outside.
constexpr double beyond = 1e6;

constexpr unsigned packet = 16;

// The plane of one triangle, in recentred coordinates, with the polygon that the triangle belongs to.
struct Plane {
  Vector normal;
  double offset = 0;
  PolygonIndex polygon = no_polygon;

  double height(const Point& point) const { return normal.dot(point) - offset; }
};

// One ray in double: what decides whether a hit that Embree finds in single precision is one.
struct ExactRay {
  Point from;
  Point to;  // or, for a ray without an end, a point far along it
  PolygonIndex from_polygon = no_polygon;
  PolygonIndex to_polygon = no_polygon;
};

// What the filter needs beside Embree's own context.
struct Context {
  RTCIntersectContext embree;  // first, so that a pointer to it is a pointer to the whole
  const ExactRay* rays;
};

// A polygon stands in the way only if it is neither of those the ray starts and ends on and its plane separates the
// ray's two ends. So hits next to an end, where single precision cannot tell before from behind, are decided in double.
bool separates(const Plane& plane, const ExactRay& ray) {
  if (plane.polygon == ray.from_polygon || plane.polygon == ray.to_polygon) return false;
  const double from = plane.height(ray.from);
  const double to = plane.height(ray.to);
  return (from > on_plane_tolerance && to < -on_plane_tolerance) ||
         (from < -on_plane_tolerance && to > on_plane_tolerance);
}

void keep_separating_hits(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const Context*>(arguments->context);
  const auto* planes = static_cast<const Plane*>(arguments->geometryUserPtr);
  for (unsigned k = 0; k < arguments->N; ++k) {
    if (arguments->valid[k] != -1) continue;
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, k);
    const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, k);
    if (!separates(planes[triangle], context->rays[ray])) arguments->valid[k] = 0;
  }
}

void fail_on_error(void*, RTCError, const char* message) {
  throw std::runtime_error(std::string("Embree: ") + message);
}

RTCIntersectContext new_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return context;
}

// The triangles of some polygons, ready to be traced.
struct TriangleScene {
  RTCScene scene = nullptr;
  std::vector<Plane> planes;  // per triangle

  TriangleScene() = default;
  TriangleScene(const TriangleScene&) = delete;
  TriangleScene& operator=(const TriangleScene&) = delete;
  ~TriangleScene() {
    if (scene) rtcReleaseScene(scene);
  }
};

}  // namespace

struct Occluder::Tracer {
  RTCDevice device = nullptr;
  Point centre = Point::Zero();
  double scale = 1;  // 1 / extent: rays are traced in a scene of about unit size
  TriangleScene everything;
  TriangleScene blockers;  // those that can block a segment

  Tracer(const Scene& scene, Blockers blockers);
  ~Tracer() { rtcReleaseDevice(device); }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  Point recentred(const Point& point) const { return scale * (point - centre); }
  void build(TriangleScene& target, const Scene& scene, const std::vector<std::uint8_t>& left_out) const;
  void trace_packet(std::span<const Segment> segments, std::uint8_t* blocked) const;
};

Occluder::Tracer::Tracer(const Scene& scene, Blockers which) : device(rtcNewDevice(nullptr)) {
  rtcSetDeviceErrorFunction(device, fail_on_error, nullptr);
  const Box box = bounds(scene);
  centre = box.center();
  scale = 1 / box.diagonal().norm();
  const std::vector<std::uint8_t> none(scene.polygons.size(), 0);
  build(everything, scene, none);
  build(blockers, scene, which == Blockers::all ? none : on_convex_hull(scene));
}

void Occluder::Tracer::build(TriangleScene& target, const Scene& scene,
                             const std::vector<std::uint8_t>& left_out) const {
  std::vector<Eigen::Vector3f> corners;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (left_out[p]) continue;
    std::vector<Point> points = corner_points(scene, p);
    for (Point& point : points) point = recentred(point);
    for (const auto& [a, b, c] : triangulate(points)) {
      for (const std::uint32_t corner : {a, b, c}) corners.push_back(points[corner].cast<float>());
      const Vector normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
      target.planes.push_back({normal, normal.dot(points[a]), p});
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
    for (std::size_t k = 0; k < corners.size(); ++k) {
      for (int d = 0; d < 3; ++d) vertices[3 * k + static_cast<std::size_t>(d)] = corners[k][d];
      indices[k] = static_cast<unsigned>(k);
    }
    rtcSetGeometryUserData(geometry, target.planes.data());
    rtcSetGeometryOccludedFilterFunction(geometry, keep_separating_hits);
    rtcSetGeometryIntersectFilterFunction(geometry, keep_separating_hits);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(target.scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(target.scene);
}

void Occluder::Tracer::trace_packet(std::span<const Segment> segments, std::uint8_t* blocked) const {
  alignas(64) RTCRay16 rays;
  alignas(64) int valid[packet];
  ExactRay exact[packet];
  for (unsigned k = 0; k < packet; ++k) {
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
    rays.tnear[k] = 0;
    rays.tfar[k] = 1;
    rays.time[k] = 0;
    rays.mask[k] = ~0U;
    rays.id[k] = k;
    rays.flags[k] = 0;
    valid[k] = k < segments.size() ? -1 : 0;
  }
  Context context{new_context(), exact};
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, blockers.scene, &context.embree, &rays);
  for (std::size_t k = 0; k < segments.size(); ++k) blocked[k] = rays.tfar[k] < 0;
}

Occluder::Occluder(const Scene& scene, Blockers blockers) : tracer_(std::make_unique<Tracer>(scene, blockers)) {}
Occluder::~Occluder() = default;
Occluder::Occluder(Occluder&&) noexcept = default;
Occluder& Occluder::operator=(Occluder&&) noexcept = default;

bool Occluder::can_occlude() const { return !tracer_->blockers.planes.empty(); }

std::vector<std::uint8_t> Occluder::occluded(std::span<const Segment> segments) const {
  std::vector<std::uint8_t> blocked(segments.size(), 0);
  if (!can_occlude()) return blocked;
  for (std::size_t k = 0; k < segments.size(); k += packet) {
    const std::size_t count = std::min<std::size_t>(packet, segments.size() - k);
    tracer_->trace_packet(segments.subspan(k, count), blocked.data() + k);
  }
  return blocked;
}

std::vector<std::optional<Hit>> Occluder::first_hits(std::span<const Ray> rays) const {
  std::vector<std::optional<Hit>> hits(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Ray& ray = rays[k];
    const Point start = tracer_->recentred(ray.origin);
    const Eigen::Vector3f origin = start.cast<float>();
    const Eigen::Vector3f direction = ray.direction.cast<float>();
    RTCRayHit query{};
    query.ray = {origin.x(),
                 origin.y(),
                 origin.z(),
                 0,
                 direction.x(),
                 direction.y(),
                 direction.z(),
                 0,
                 std::numeric_limits<float>::infinity(),
                 ~0U,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    const ExactRay exact{start, start + beyond * ray.direction, ray.from_polygon, no_polygon};
    Context context{new_context(), &exact};
    rtcIntersect1(tracer_->everything.scene, &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;

    // The hit in double: where the ray meets the triangle's plane, unless it grazes.
    const Plane& plane = tracer_->everything.planes[query.hit.primID];
    const double cosine = plane.normal.dot(ray.direction);
    const bool grazes = std::abs(cosine) < 1e-3;
    const double distance =
        (grazes ? static_cast<double>(query.ray.tfar) : -plane.height(start) / cosine) / tracer_->scale;
    hits[k] =
        Hit{plane.polygon, cosine < 0 ? Side::front : Side::back, ray.origin + distance * ray.direction, distance};
  }
  return hits;
}

}  // namespace patchlight
