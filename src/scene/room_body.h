#pragma once

#include "patchlight/base/geometry.h"

#include <vector>

namespace patchlight {

/// The body of air that a room's faces enclose, whichever way they are turned.
class RoomBody {
 public:
  explicit RoomBody(const std::vector<std::vector<Point>>& faces);
  /// True inside: the faces are seen from there under more than half of the sphere, as signed solid angles add up.
  /// Takes as long as there are corners.
  bool holds(const Point& point) const;
  /// How far from its walls a point is to be for rounding not to matter, metres.
  double step() const;

 private:
  std::vector<std::vector<Point>> faces_;
  Box box_;
};

}  // namespace patchlight
