#pragma once

#include "patchlight/base/geometry.h"

#include <Eigen/Geometry>
#include <cmath>

namespace patchlight {

/// The axes of a map of sensors, unit vectors.
struct MapAxes {
  Vector right, above;
};

/// Level sensors are seen from above with north above, others from the side that they face, `normal`.
inline MapAxes map_axes(const Vector& normal, const Vector& up, const Vector& north) {
  constexpr double level = 0.7;
  if (std::abs(normal.dot(up)) > level) return {north.cross(up).normalized(), north};
  const Vector right = up.cross(normal).normalized();
  return {right, normal.cross(right).normalized()};
}

}  // namespace patchlight
