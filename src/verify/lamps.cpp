#include "verify/lamps.h"

#include "base/sampling.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace patchlight {

Lamps lamps_of(const Scene& scene, const Surfaces& surfaces) {
  Lamps lamps;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> points = corner_points(scene, p);
    for (const Side side : {Side::front, Side::back}) {
      const double exitance = surfaces.at(p, side).exitance.mean();
      if (!(exitance > 0)) continue;
      for (const auto& [a, b, c] : triangulate(points)) {
        lamps.triangles.push_back({{points[a], points[b], points[c]}, p, side});
        lamps.flux_before.push_back(lamps.flux);
        lamps.flux += exitance * (points[b] - points[a]).cross(points[c] - points[a]).norm() / 2;
      }
    }
  }
  return lamps;
}

LampPoint sample(const Lamps& lamps, double u, double v) {
  assert(lamps.flux > 0);
  // The triangle whose share of the flux holds u, which is stretched over that share to be used again.
  const double wanted = u * lamps.flux;
  const auto above = std::upper_bound(lamps.flux_before.begin() + 1, lamps.flux_before.end(), wanted);
  const auto t = static_cast<std::size_t>(std::distance(lamps.flux_before.begin(), above)) - 1;
  const double end = t + 1 < lamps.flux_before.size() ? lamps.flux_before[t + 1] : lamps.flux;
  const double stretched = (wanted - lamps.flux_before[t]) / (end - lamps.flux_before[t]);

  const LampTriangle& triangle = lamps.triangles[t];
  const auto& [p0, p1, p2] = triangle.corners;
  const Eigen::Vector2d b = square_to_triangle(std::clamp(stretched, 0.0, 1.0), v);
  return {p0 + b[0] * (p1 - p0) + b[1] * (p2 - p0), triangle.polygon, triangle.side};
}

double sampling_density(const Lamps& lamps, const Surface& surface) { return surface.exitance.mean() / lamps.flux; }

}  // namespace patchlight
