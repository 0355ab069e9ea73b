#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace patchlight {

/// A position in meters.
using Point = Eigen::Vector3d;

/// A direction or displacement; displacements are in meters.
using Vector = Eigen::Vector3d;

/// An axis-aligned box in meters.
using Box = Eigen::AlignedBox3d;

/// Vector area of a closed polygon (Newell): its length is the area in m^2, its direction the side from which
/// the corners run counter-clockwise. Zero for degenerate polygons.
Vector area_vector(std::span<const Point> polygon);

/// Area centroid of a planar polygon; the mean of the corners when the polygon has no area.
Point area_centroid(std::span<const Point> polygon);

/// The part of a convex polygon where normal . (x - on_plane) >= 0, up to 1e-9 of the distance from `on_plane`. Empty
/// when nothing is left.
std::vector<Point> clip_to_half_space(std::span<const Point> polygon, const Point& on_plane, const Vector& normal);

/// Solid angle in steradian, signed, of triangle (a, b, c) seen from `eye`: positive when `eye` is behind the triangle,
/// so that a closed surface with outward normals adds up to 4 pi around a point inside. Van Oosterom and Strackee 1983,
/// eq. 8.
double signed_solid_angle(const Point& eye, const Point& a, const Point& b, const Point& c);

}  // namespace patchlight
