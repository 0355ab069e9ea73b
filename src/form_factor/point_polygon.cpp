#include "form_factor/point_polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {

double point_to_polygon(const Point& point, const Vector& normal, std::span<const Point> polygon) {
  // Cut away what lies below the horizon; most polygons lie above.
  const auto below = [&](const Point& corner) { return normal.dot(corner - point) < 0; };
  std::vector<Point> clipped;
  if (std::any_of(polygon.begin(), polygon.end(), below)) {
    clipped = clip_to_half_space(polygon, point, normal);
    polygon = clipped;
  }

  // F = -1/(2 pi) sum_k n . (R_k x R_k+1) atan2(|R_k x R_k+1|, R_k . R_k+1) / |R_k x R_k+1|
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vector here = polygon[k] - point;
    const Vector next = polygon[k + 1 < polygon.size() ? k + 1 : 0] - point;
    const Vector cross = here.cross(next);
    const double length = cross.norm();
    if (length > 0) sum -= normal.dot(cross) / length * std::atan2(length, here.dot(next));
  }
  return std::clamp(sum / (2 * std::numbers::pi), 0.0, 1.0);
}

}  // namespace patchlight
