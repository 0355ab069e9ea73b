#pragma once

#include "patchlight/scene/scene.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Planar faces that approximate a round surface. Seen from the front, corners run counter-clockwise.
struct FacetedShape {
  std::vector<Point> points;
  std::vector<std::vector<std::uint32_t>> faces;  ///< corner indices into `points`
};

/// Adds the faces of a shape, transformed by `placed`, as polygons like this one; reversed if `is_turned`.
template <class Placed>
Scene with_shape(Scene scene, const FacetedShape& shape, const Placed& placed, bool is_turned, Polygon polygon) {
  const auto first = static_cast<std::uint32_t>(scene.vertices.size());
  for (const Point& point : shape.points) scene.vertices.push_back(placed(point));
  for (const std::vector<std::uint32_t>& face : shape.faces) {
    polygon.corners = face;
    for (std::uint32_t& corner : polygon.corners) corner += first;
    if (is_turned) std::reverse(polygon.corners.begin(), polygon.corners.end());
    scene.polygons.push_back(polygon);
  }
  return scene;
}

/// Number of sides of a round surface around its axis.
inline constexpr std::uint32_t round_sides = 24;

/// A sphere of 24 x 12 facets, fronts outward. Its corners lie outside the sphere such that the area is 4 pi r^2.
FacetedShape faceted_sphere(const Point& centre, double radius);

/// The side of a truncated cone between two circles around the line from `a` to `b`, fronts outward. Equal radii give a
/// cylinder; one radius may be 0. Radii are enlarged such that the area is pi (r_a + r_b) sqrt(h^2 + (r_a - r_b)^2).
/// Empty for coincident circles of equal radii.
FacetedShape faceted_cone(const Point& a, const Point& b, double radius_a, double radius_b);

/// A disk, or the ring between two circles, with the front toward `normal`. Radii are enlarged such that the area is pi
/// (r_outer^2 - r_inner^2).
FacetedShape faceted_ring(const Point& centre, const Vector& normal, double inner, double outer);

/// The rotation about a unit vector, counter-clockwise seen from its tip; exact for quarter turns about coordinate
/// axes.
Eigen::Matrix3d turned_about(const Vector& axis, double degrees);

}  // namespace patchlight
