#include "patchlight/visibility/occluder.h"

#include "patchlight/scene/triangulate.h"
#include "patchlight/visibility/convex_hull.h"

#include "base/target_clones.h"
#include "visibility/flat_polygon.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <embree3/rtcore.h>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace patchlight {
namespace {

// A point nearer to a plane than this share of the scene's extent lies on it.
constexpr double on_plane_tolerance = 1e-9;

// The same for rays whose ends are given in single precision: what rounding a point of the scene leaves of its height.
constexpr double on_plane_tolerance_of_packets = 3e-7;

// Rays are traced in a scene of unit extent: so far along a ray lies nothing any more. Origins may lie outside.
constexpr double beyond = 1e6;

constexpr unsigned packet_size = ShadowPacket::size;

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
  const ExactRay* rays = nullptr;
  const ShadowPacket* packet = nullptr;  // in place of rays
};

// A polygon stands in the way only if it is neither of those the ray starts and ends on and its plane separates the
// ray's two ends. So hits next to an end, where single precision cannot tell before from behind, are decided in double.
bool separates(const Plane& plane, const ExactRay& ray, double tolerance) {
  if (plane.polygon == ray.from_polygon || plane.polygon == ray.to_polygon) return false;
  const double from = plane.height(ray.from);
  const double to = plane.height(ray.to);
  return (from > tolerance && to < -tolerance) || (from < -tolerance && to > tolerance);
}

ExactRay exact_ray(const ShadowPacket& rays, std::size_t k) {
  const Point from(rays.from_x[k], rays.from_y[k], rays.from_z[k]);
  const Vector toward(rays.toward_x[k], rays.toward_y[k], rays.toward_z[k]);
  return {from, from + toward, rays.from_polygon[k], rays.to_polygon[k]};
}

// Marks the hits that are beyond doubt: the ray's ends are so far on either side of the triangle's plane, by
// t |n . d| and (1 - t) |n . d|, that single precision tells them apart.
template <unsigned N>
PATCHLIGHT_INLINE void mark_clear_hits(const RTCFilterFunctionNArguments& hits, unsigned char* clear) {
  constexpr float clear_height = 1e-4F;
  for (unsigned k = 0; k < N; ++k) {
    const float x = RTCHitN_Ng_x(hits.hit, N, k);
    const float y = RTCHitN_Ng_y(hits.hit, N, k);
    const float z = RTCHitN_Ng_z(hits.hit, N, k);
    const float t = RTCRayN_tfar(hits.ray, N, k);
    const float nearer = std::min(t, 1 - t);
    const float height = nearer * (x * RTCRayN_dir_x(hits.ray, N, k) + y * RTCRayN_dir_y(hits.ray, N, k) +
                                   z * RTCRayN_dir_z(hits.ray, N, k));
    const float least = clear_height * clear_height * (x * x + y * y + z * z);
    clear[k] = static_cast<unsigned char>(static_cast<int>(height * height > least) & static_cast<int>(nearer > 0));
  }
}

PATCHLIGHT_TARGET_CLONES
void keep_separating_hits(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const Context*>(arguments->context);
  const auto* planes = static_cast<const Plane*>(arguments->geometryUserPtr);
  std::array<unsigned char, packet_size> clear{};
  if (arguments->N == packet_size && context->packet != nullptr) mark_clear_hits<packet_size>(*arguments, clear.data());
  for (unsigned k = 0; k < arguments->N; ++k) {
    if (arguments->valid[k] != -1) continue;
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, k);
    const unsigned triangle = RTCHitN_primID(arguments->hit, arguments->N, k);
    if (clear[k] != 0) {
      const PolygonIndex polygon = planes[triangle].polygon;
      const ShadowPacket& rays = *context->packet;
      if (polygon == rays.from_polygon[ray] || polygon == rays.to_polygon[ray]) arguments->valid[k] = 0;
      continue;
    }
    const bool blocks =
        context->packet != nullptr
            ? separates(planes[triangle], exact_ray(*context->packet, ray), on_plane_tolerance_of_packets)
            : separates(planes[triangle], context->rays[ray], on_plane_tolerance);
    if (!blocks) arguments->valid[k] = 0;
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

// What Embree is asked for one ray, in recentred coordinates.
RTCRayHit new_query(const Point& from, const Vector& toward, float farthest) {
  const Eigen::Vector3f o = from.cast<float>();
  const Eigen::Vector3f d = toward.cast<float>();
  RTCRayHit query{};
  query.ray = {o.x(), o.y(), o.z(), 0, d.x(), d.y(), d.z(), 0, farthest, ~0U, 0, 0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

std::vector<std::uint8_t> none_of(const Scene& scene) { return std::vector<std::uint8_t>(scene.polygons.size(), 0); }

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
  std::vector<std::uint8_t> left_out;
  ShaftCuller shafts;
  std::vector<FlatPolygon> polygons;  // of the scene, recentred

  Tracer(const Scene& scene, Blockers blockers);
  ~Tracer() { rtcReleaseDevice(device); }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  Point recentred(const Point& point) const { return scale * (point - centre); }
  void build(TriangleScene& target, const Scene& scene, const std::vector<std::uint8_t>& without) const;
  std::optional<PolygonIndex> first_polygon(const Point& from, const Point& to) const;
  void trace_packet(std::span<const Segment> segments, std::uint8_t* blocked) const;
};

Occluder::Tracer::Tracer(const Scene& scene, Blockers which)
    : device(rtcNewDevice(nullptr)),
      left_out(which == Blockers::all ? none_of(scene) : on_convex_hull(scene)),
      shafts(scene, left_out) {
  rtcSetDeviceErrorFunction(device, fail_on_error, nullptr);
  const Box box = bounds(scene);
  centre = box.center();
  scale = 1 / box.diagonal().norm();
  build(everything, scene, none_of(scene));
  build(blockers, scene, left_out);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    std::vector<Point> points = corner_points(scene, p);
    for (Point& point : points) point = recentred(point);
    polygons.push_back(flat_polygon(points));
  }
}

void Occluder::Tracer::build(TriangleScene& target, const Scene& scene,
                             const std::vector<std::uint8_t>& without) const {
  std::vector<Eigen::Vector3f> corners;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (without[p]) continue;
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
  alignas(64) int valid[packet_size];
  ExactRay exact[packet_size];
  for (unsigned k = 0; k < packet_size; ++k) {
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
  Context context{new_context(), exact, nullptr};
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, blockers.scene, &context.embree, &rays);
  for (std::size_t k = 0; k < segments.size(); ++k) blocked[k] = rays.tfar[k] < 0;
}

std::uint16_t Occluder::occluded(const ShadowPacket& packet) const {
  alignas(64) RTCRay16 rays;
  alignas(64) int valid[ShadowPacket::size];
  for (std::size_t k = 0; k < ShadowPacket::size; ++k) {
    rays.org_x[k] = packet.from_x[k];
    rays.org_y[k] = packet.from_y[k];
    rays.org_z[k] = packet.from_z[k];
    rays.dir_x[k] = packet.toward_x[k];
    rays.dir_y[k] = packet.toward_y[k];
    rays.dir_z[k] = packet.toward_z[k];
    rays.tnear[k] = 0;
    rays.tfar[k] = 1;
    rays.time[k] = 0;
    rays.mask[k] = ~0U;
    rays.id[k] = static_cast<unsigned>(k);
    rays.flags[k] = 0;
    valid[k] = -1;
  }
  Context context{new_context(), nullptr, &packet};
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, tracer_->blockers.scene, &context.embree, &rays);
  unsigned blocked = 0;
  for (unsigned k = 0; k < ShadowPacket::size; ++k) blocked |= static_cast<unsigned>(rays.tfar[k] < 0) << k;
  return static_cast<std::uint16_t>(blocked);
}

// The first polygon that can block between two points, in recentred coordinates.
std::optional<PolygonIndex> Occluder::Tracer::first_polygon(const Point& from, const Point& to) const {
  RTCRayHit query = new_query(from, to - from, 1);
  const ExactRay exact{from, to, no_polygon, no_polygon};
  Context context{new_context(), &exact, nullptr};
  rtcIntersect1(blockers.scene, &context.embree, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return blockers.planes[query.hit.primID].polygon;
}

bool Occluder::hides(std::span<const Point> first, std::span<const Point> second) const {
  std::vector<Point> from;
  std::vector<Point> to;
  for (const Point& point : first) from.push_back(tracer_->recentred(point));
  for (const Point& point : second) to.push_back(tracer_->recentred(point));
  const auto middle = [](const std::vector<Point>& points) {
    return Point(std::accumulate(points.begin(), points.end(), Point(Point::Zero())) /
                 static_cast<double>(points.size()));
  };
  const auto met = tracer_->first_polygon(middle(from), middle(to));
  if (!met) return false;
  const std::vector<FlatPolygon>& polygons = tracer_->polygons;
  if (cuts_all(polygons[*met], from, to, on_plane_tolerance_of_packets)) return true;
  const auto other = tracer_->first_polygon(middle(to), middle(from));
  return other && *other != *met && cuts_all(polygons[*other], from, to, on_plane_tolerance_of_packets);
}

const ShaftCuller& Occluder::shafts() const { return tracer_->shafts; }

TracingFrame Occluder::frame() const { return {tracer_->centre, tracer_->scale}; }

Occluder::Occluder(const Scene& scene, Blockers blockers) : tracer_(std::make_unique<Tracer>(scene, blockers)) {}
Occluder::~Occluder() = default;
Occluder::Occluder(Occluder&&) noexcept = default;
Occluder& Occluder::operator=(Occluder&&) noexcept = default;

bool Occluder::can_occlude() const { return !tracer_->blockers.planes.empty(); }

std::vector<std::uint8_t> Occluder::occluded(std::span<const Segment> segments) const {
  std::vector<std::uint8_t> blocked(segments.size(), 0);
  if (!can_occlude()) return blocked;
  for (std::size_t k = 0; k < segments.size(); k += packet_size) {
    const std::size_t count = std::min<std::size_t>(packet_size, segments.size() - k);
    tracer_->trace_packet(segments.subspan(k, count), blocked.data() + k);
  }
  return blocked;
}

std::vector<std::optional<Hit>> Occluder::first_hits(std::span<const Ray> rays) const {
  std::vector<std::optional<Hit>> hits(rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Ray& ray = rays[k];
    const Point start = tracer_->recentred(ray.origin);
    RTCRayHit query = new_query(start, ray.direction, std::numeric_limits<float>::infinity());
    const ExactRay exact{start, start + beyond * ray.direction, ray.from_polygon, no_polygon};
    Context context{new_context(), &exact, nullptr};
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
