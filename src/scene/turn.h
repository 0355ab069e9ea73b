#pragma once

#include "patchlight/base/geometry.h"

namespace patchlight {

/// Twice the signed area of a triangle in m^2, positive when it turns left around the unit normal.
inline double turn(const Vector& normal, const Point& a, const Point& b, const Point& c) {
  return normal.dot((b - a).cross(c - a));
}

}  // namespace patchlight
