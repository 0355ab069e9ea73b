#pragma once

#include "patchlight/base/geometry.h"

#include <vector>

namespace patchlight {

/// The body of air that a room's faces enclose, whichever way each is turned.
class RoomBody {
 public:
  explicit RoomBody(const std::vector<std::vector<Point>>& faces);
  /// True inside: two of three rays from there cross the faces an odd number of times. O(n) for n corners.
  bool holds(const Point& point) const;
  /// How far from its walls a point is to be for rounding not to matter, metres.
  double step() const;

 private:
  std::vector<std::vector<Point>> faces_;
  Box box_;
};

}  // namespace patchlight
