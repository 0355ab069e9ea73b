#pragma once

#include "patchlight/scene/scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Polygons whose normals are nearer to each other than 30 degrees go on over a common edge: its cosine.
inline constexpr double smooth_cosine = 0.86602540378443865;

/// A polygon's boundary as the mesher sees it.
struct Outline {
  std::vector<Point> corners;        ///< counter-clockwise from the front, no two consecutive ones at one place
  std::vector<std::uint32_t> parts;  ///< of the edge from each corner to the next
  Vector normal;                     ///< unit, of the front
  std::vector<std::array<Point, 2>> lines = {};  ///< inside, for patches to end at: they meet each other and the
                                                 ///< outline in their ends alone, and there in corners
};

/// The mesh of one polygon. Boundary points come first: every corner followed by the points on the edge after it.
struct PolygonMesh {
  std::vector<Point> inner;                           ///< the points that follow those of the boundary
  std::vector<std::array<std::uint32_t, 4>> patches;  ///< counter-clockwise from the front; a triangle repeats its last
};

/// True when a comes before b in the order of their coordinates.
bool comes_before(const Point& a, const Point& b);

/// Into how many parts an edge is cut for none to be longer than `max_edge`.
std::uint32_t parts_of(const Point& from, const Point& to, double max_edge);

Outline make_outline(std::vector<Point> corners, const Vector& normal, double max_edge);

/// Point `index` of 0 to `parts` on an edge. Taken from the end that comes first, so that it has the same bits
/// whichever way the edge is traversed.
Point edge_point(const Point& from, const Point& to, std::uint32_t index, std::uint32_t parts);

/// All boundary points in the order of PolygonMesh.
std::vector<Point> boundary_points(const Outline& outline);

}  // namespace patchlight
