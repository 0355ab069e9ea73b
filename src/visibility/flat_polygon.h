#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include "scene/coverings.h"

#include <cstdint>
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

/// True when a point of the polygon's plane lies inside the polygon.
bool contains(const FlatPolygon& polygon, const Point& point);

/// True when the polygon cuts every segment from the convex hull of one group of points to that of another, both
/// farther than `tolerance` from its plane. May be false in narrow cases: a rectangle inside the polygon must hold all
/// crossings, and the seam of a hole counts as an edge.
bool cuts_all(const FlatPolygon& polygon, std::span<const Point> from, std::span<const Point> to, double tolerance);

/// Per polygon: 1 when all vertices of the scene lie on one side of its plane, up to 1e-6 of the scene's extent. Such a
/// polygon is part of the convex hull and cannot stand between two points of the scene. O(polygons) for most scenes,
/// O(polygons x vertices) for convex ones.
std::vector<std::uint8_t> on_convex_hull(const Scene& scene);

/// The places of polygons that another polygon covers, in recentered coordinates.
struct CoveredPlaces {
  Coverings coverings;
  std::vector<FlatPolygon> polygons;       ///< of the scene
  std::vector<Eigen::AlignedBox3f> boxes;  ///< around them, a little larger: few bytes that exclude most polygons

  bool any() const { return !coverings.over.empty(); }

  /// Appends the next polygon of the scene.
  void add(std::span<const Point> corners);

  bool covers(PolygonIndex polygon, Side side, const Point& place) const;

  /// True if one of two polygons lies over the other in one plane, up to rounding. O(log n) for n polygons over one.
  bool lie_in_one_plane(PolygonIndex a, PolygonIndex b) const;

  /// True when one end of a segment lies on a covered place of the polygon there, on the side that the segment sees.
  bool covers_end(const Point& from, const Point& to, PolygonIndex from_polygon, PolygonIndex to_polygon) const;
};

}  // namespace patchlight
