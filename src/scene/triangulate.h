#pragma once

#include "patchlight/base/geometry.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace patchlight {

/// Triangles (indices into `polygon`) that cover a simple planar polygon, convex or not, with its orientation; n - 2 of
/// them for n corners. Convex quadrilaterals are cut along their shorter diagonal. O(n log n) for n corners of
/// most outlines, O(n^2) in the worst case.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Point> polygon);

using Triangle = std::array<Point, 3>;

/// The same as points.
std::vector<Triangle> triangles_of(std::span<const Point> polygon);

/// The middle of the largest triangle: inside of the polygon even when that is not convex.
Point inner_point(std::span<const Point> polygon);

/// The area in m^2 that triangles have in common as seen along a unit normal, which is that of their parallel planes;
/// stops where that is more than `enough`. O(n m) for n and m triangles.
double common_area(std::span<const Triangle> some, std::span<const Triangle> others, const Vector& normal,
                   double enough = std::numeric_limits<double>::infinity());

/// The polygon in triangles, with their last corner twice, or as it is if it is a quadrilateral with four corners that
/// turn outward; with its orientation.
std::vector<std::array<Point, 4>> convex_pieces(std::span<const Point> polygon);

/// True when no corner of the planar polygon turns inward.
bool is_convex(std::span<const Point> polygon);

/// Twice the signed area of a triangle in m^2, positive when it turns left around the unit normal.
inline double turn(const Vector& normal, const Point& a, const Point& b, const Point& c) {
  return normal.dot((b - a).cross(c - a));
}

/// The square of the distance of a point to a segment, m^2.
inline double squared_distance(const Point& point, const Point& from, const Point& to) {
  const Vector edge = to - from;
  const double t = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
  return (from + t * edge - point).squaredNorm();
}

/// True when a point of its plane lies in a triangle that turns left around the normal, or on its rim.
inline bool contains(const Vector& normal, const Point& a, const Point& b, const Point& c, const Point& x) {
  return turn(normal, a, b, x) >= 0 && turn(normal, b, c, x) >= 0 && turn(normal, c, a, x) >= 0;
}

}  // namespace patchlight
