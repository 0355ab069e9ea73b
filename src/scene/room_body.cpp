#include "scene/room_body.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace patchlight {
namespace {

// Does the ray from the origin meet the triangle? Moeller and Trumbore 1997.
bool meets(const Vector& direction, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, ac = c - a;
  const Vector across = direction.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return false;
  const double u = -a.dot(across) / determinant;
  const Vector q = (-a).cross(ab);
  const double v = direction.dot(q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && ac.dot(q) / determinant > 0;
}

// Triangles of a fan overlap outside of a polygon that is not convex, an even number of times.
bool is_inside(const std::vector<std::vector<Point>>& faces, const Point& point, const Vector& direction) {
  std::size_t crossings = 0;
  for (const std::vector<Point>& face : faces) {
    for (std::size_t k = 2; k < face.size(); ++k)
      crossings += meets(direction, face[0] - point, face[k - 1] - point, face[k] - point) ? 1 : 0;
  }
  return crossings % 2 == 1;
}

}  // namespace

RoomBody::RoomBody(const std::vector<std::vector<Point>>& faces) : faces_(faces) {
  for (const std::vector<Point>& face : faces_) {
    for (const Point& corner : face) box_.extend(corner);
  }
}

bool RoomBody::holds(const Point& point) const {
  if (!box_.contains(point)) return false;
  // An edge that one ray just meets is counted twice or not at all: two of three decide.
  const std::array<Vector, 3> directions = {Vector(0.5377, 0.2113, 0.8163), Vector(-0.7071, 0.6433, 0.2937),
                                            Vector(0.1931, -0.8701, 0.4535)};
  const auto votes = std::count_if(directions.begin(), directions.end(),
                                   [&](const Vector& direction) { return is_inside(faces_, point, direction); });
  return votes >= 2;
}

double RoomBody::step() const {
  constexpr double small = 1e-3;
  return box_.isEmpty() ? 0 : small * box_.diagonal().norm();
}

}  // namespace patchlight
