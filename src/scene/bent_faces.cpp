#include "scene/bent_faces.h"

#include "base/parallel.h"
#include "scene/extent.h"
#include "scene/triangulate.h"

#include <algorithm>

namespace patchlight {
namespace {

// How far the corners of a polygon are from lying in one plane, metres.
double bend_of(const Scene& scene, PolygonIndex polygon) {
  const Vector normal = front_normal(scene, polygon);
  double lowest = 0;
  double highest = 0;
  for (const Point& corner : corner_points(scene, polygon)) {
    const double height = normal.dot(corner - scene.vertices[scene.polygons[polygon].corners[0]]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return highest - lowest;
}

}  // namespace

std::vector<std::uint8_t> bent_faces(const Scene& scene) {
  const double touch = weld_distance(scene);
  std::vector<std::uint8_t> is_bent(scene.polygons.size(), 0);
  parallel_for(is_bent.size(),
               [&](std::size_t p) { is_bent[p] = bend_of(scene, static_cast<PolygonIndex>(p)) > touch ? 1 : 0; });
  std::vector<std::uint8_t> is_rounded(scene.vertices.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_bent[p] == 0) continue;
    for (const std::uint32_t corner : scene.polygons[p].corners) is_rounded[corner] = 1;
  }
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    if (std::any_of(corners.begin(), corners.end(), [&](std::uint32_t corner) { return is_rounded[corner] != 0; }))
      is_bent[p] = 1;
  }
  return is_bent;
}

}  // namespace patchlight
