#include "scene/room_body.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

// The signed solid angle of a triangle: Van Oosterom and Strackee 1983, eq. 8.
double solid_angle(const Vector& a, const Vector& b, const Vector& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double above = a.dot(b.cross(c));
  const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return 2 * std::atan2(above, below);
}

}  // namespace

RoomBody::RoomBody(const std::vector<std::vector<Point>>& faces) : faces_(faces) {
  for (const std::vector<Point>& face : faces_) {
    for (const Point& corner : face) box_.extend(corner);
  }
}

bool RoomBody::holds(const Point& point) const {
  if (!box_.contains(point)) return false;
  double sum = 0;
  for (const std::vector<Point>& face : faces_) {
    for (std::size_t k = 2; k < face.size(); ++k)
      sum += solid_angle(face[0] - point, face[k - 1] - point, face[k] - point);
  }
  return std::abs(sum) > 2 * std::numbers::pi;
}

double RoomBody::step() const {
  constexpr double small = 1e-3;
  return box_.isEmpty() ? 0 : small * box_.diagonal().norm();
}

}  // namespace patchlight
