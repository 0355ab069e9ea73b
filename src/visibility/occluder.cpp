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

// Hits nearer to an end of a segment are ignored: this share of the scene's extent plus this share of the length.
constexpr float extent_offset = 2e-6F;
constexpr float length_offset = 1e-5F;

constexpr unsigned packet = 16;

// What the filters need beside Embree's own context: the polygons that the rays of one packet start and end on.
struct Context {
  RTCIntersectContext embree;  // first, so that a pointer to it is a pointer to the whole
  const PolygonIndex* from;
  const PolygonIndex* to;  // null when rays have no end
};

// Rejects hits on a ray's two end polygons. The geometry's user data is the polygon of each triangle.
void ignore_end_polygons(const RTCFilterFunctionNArguments* arguments) {
  const auto* context = reinterpret_cast<const Context*>(arguments->context);
  const auto* polygon_of = static_cast<const PolygonIndex*>(arguments->geometryUserPtr);
  for (unsigned k = 0; k < arguments->N; ++k) {
    if (arguments->valid[k] != -1) continue;
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, k);
    const PolygonIndex polygon = polygon_of[RTCHitN_primID(arguments->hit, arguments->N, k)];
    if (polygon == context->from[ray] || (context->to && polygon == context->to[ray])) arguments->valid[k] = 0;
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
  std::vector<PolygonIndex> polygon_of;  // per triangle

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
  TriangleScene blockers;      // all but the polygons on the convex hull
  std::vector<Vector> normal;  // per polygon
  std::vector<Point> on_plane;

  explicit Tracer(const Scene& scene);
  ~Tracer() { rtcReleaseDevice(device); }
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  Eigen::Vector3f narrowed(const Point& point) const { return (scale * (point - centre)).cast<float>(); }
  void build(TriangleScene& target, const Scene& scene, const std::vector<std::uint8_t>& left_out) const;
  void trace_packet(std::span<const Segment> segments, std::uint8_t* blocked) const;
};

Occluder::Tracer::Tracer(const Scene& scene) : device(rtcNewDevice(nullptr)) {
  rtcSetDeviceErrorFunction(device, fail_on_error, nullptr);
  const Box box = bounds(scene);
  centre = box.center();
  scale = 1 / box.diagonal().norm();
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    normal.push_back(front_normal(scene, p));
    on_plane.push_back(scene.vertices[scene.polygons[p].corners[0]]);
  }
  build(everything, scene, std::vector<std::uint8_t>(scene.polygons.size(), 0));
  build(blockers, scene, on_convex_hull(scene));
}

void Occluder::Tracer::build(TriangleScene& target, const Scene& scene,
                             const std::vector<std::uint8_t>& left_out) const {
  std::vector<Eigen::Vector3f> corners;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (left_out[p]) continue;
    const std::vector<Point> points = patchlight::corner_points(scene, p);
    for (const auto& triangle : triangulate(points)) {
      for (const std::uint32_t corner : triangle) corners.push_back(narrowed(points[corner]));
      target.polygon_of.push_back(p);
    }
  }
  target.scene = rtcNewScene(device);
  // Robust: rays do not slip between two triangles that share an edge.
  rtcSetSceneFlags(target.scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(target.scene, RTC_BUILD_QUALITY_HIGH);
  if (!target.polygon_of.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), corners.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), target.polygon_of.size()));
    for (std::size_t k = 0; k < corners.size(); ++k) {
      for (int d = 0; d < 3; ++d) vertices[3 * k + static_cast<std::size_t>(d)] = corners[k][d];
      indices[k] = static_cast<unsigned>(k);
    }
    rtcSetGeometryUserData(geometry, target.polygon_of.data());
    rtcSetGeometryOccludedFilterFunction(geometry, ignore_end_polygons);
    rtcSetGeometryIntersectFilterFunction(geometry, ignore_end_polygons);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(target.scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(target.scene);
}

void Occluder::Tracer::trace_packet(std::span<const Segment> segments, std::uint8_t* blocked) const {
  alignas(64) RTCRay16 rays;
  alignas(64) int valid[packet];
  PolygonIndex from[packet];
  PolygonIndex to[packet];
  for (unsigned k = 0; k < packet; ++k) {
    // Lanes beyond the last segment repeat it, so that every field of every ray is set.
    const Segment& segment = segments[std::min<std::size_t>(k, segments.size() - 1)];
    const Eigen::Vector3f origin = narrowed(segment.from);
    const Eigen::Vector3f direction = (scale * (segment.to - segment.from)).cast<float>();
    const float offset = length_offset + extent_offset / std::max(direction.norm(), std::numeric_limits<float>::min());
    rays.org_x[k] = origin.x();
    rays.org_y[k] = origin.y();
    rays.org_z[k] = origin.z();
    rays.dir_x[k] = direction.x();
    rays.dir_y[k] = direction.y();
    rays.dir_z[k] = direction.z();
    rays.tnear[k] = offset;
    rays.tfar[k] = 1 - offset;
    rays.time[k] = 0;
    rays.mask[k] = ~0U;
    rays.id[k] = k;
    rays.flags[k] = 0;
    from[k] = segment.from_polygon;
    to[k] = segment.to_polygon;
    // A segment shorter than its two offsets is free.
    valid[k] = k < segments.size() && offset < 0.5F ? -1 : 0;
  }
  Context context{new_context(), from, to};
  context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid, blockers.scene, &context.embree, &rays);
  for (std::size_t k = 0; k < segments.size(); ++k) blocked[k] = valid[k] == -1 && rays.tfar[k] < 0;
}

Occluder::Occluder(const Scene& scene) : tracer_(std::make_unique<Tracer>(scene)) {}
Occluder::~Occluder() = default;
Occluder::Occluder(Occluder&&) noexcept = default;
Occluder& Occluder::operator=(Occluder&&) noexcept = default;

bool Occluder::can_occlude() const { return !tracer_->blockers.polygon_of.empty(); }

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
    const Eigen::Vector3f origin = tracer_->narrowed(ray.origin);
    const Eigen::Vector3f direction = ray.direction.cast<float>();
    RTCRayHit query{};
    query.ray = {origin.x(),
                 origin.y(),
                 origin.z(),
                 extent_offset,
                 direction.x(),
                 direction.y(),
                 direction.z(),
                 0,
                 std::numeric_limits<float>::infinity(),
                 ~0U,
                 0,
                 0};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    Context context{new_context(), &ray.from_polygon, nullptr};
    rtcIntersect1(tracer_->everything.scene, &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;

    // The hit in double: where the ray meets the polygon's plane, unless it grazes.
    const PolygonIndex polygon = tracer_->everything.polygon_of[query.hit.primID];
    const double cosine = tracer_->normal[polygon].dot(ray.direction);
    double distance = static_cast<double>(query.ray.tfar) / tracer_->scale;
    if (std::abs(cosine) > 1e-3) {
      distance = tracer_->normal[polygon].dot(tracer_->on_plane[polygon] - ray.origin) / cosine;
    }
    hits[k] = Hit{polygon, cosine < 0 ? Side::front : Side::back, ray.origin + distance * ray.direction, distance};
  }
  return hits;
}

}  // namespace patchlight
