#pragma once

#include "patchlight/base/geometry.h"

#include <span>
#include <vector>

namespace patchlight {

/// A polygon in the coordinates of its plane.
struct FlatPolygon {
  Point origin;
  Vector u, v, normal;
  std::vector<Eigen::Vector2d> corners;
  Eigen::AlignedBox2d box;  ///< of the corners

  double height(const Point& point) const { return normal.dot(point - origin); }
  Eigen::Vector2d in_plane(const Point& point) const { return {u.dot(point - origin), v.dot(point - origin)}; }
};

FlatPolygon flat_polygon(std::span<const Point> corners);

/// True when a point of the polygon's plane lies in the polygon.
bool contains(const FlatPolygon& polygon, const Point& point);

/// True when the polygon cuts every segment from the convex hull of some points to that of others, both of them farther
/// than `tolerance` from its plane. May be false when it does by little: a rectangle of the polygon has to hold all
/// crossings, and the seam of a hole counts as an edge.
bool cuts_all(const FlatPolygon& polygon, std::span<const Point> from, std::span<const Point> to, double tolerance);

}  // namespace patchlight
