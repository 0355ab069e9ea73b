#include "visibility/traced_faces.h"

#include "scene/extent.h"
#include "scene/triangulate.h"
#include "visibility/flat_polygon.h"

#include <cstddef>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace patchlight {
namespace {

void fail_on_error(void*, RTCError code, const char* message) {
  if (code == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error(std::string("Embree: ") + message);
}

}  // namespace

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
    covered_places.polygons.push_back(flat_polygon(points));
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

}  // namespace patchlight
