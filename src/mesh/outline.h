#pragma once

#include "patchlight/scene/scene.h"

#include <array>
#include <cstddef>
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
  std::vector<std::uint8_t> is_graded = {};  ///< per edge of a grid of quadrilaterals whether patches shrink towards
                                             ///< it; empty: towards none
};

/// Towards which ends of an edge its parts become shorter.
struct Grading {
  bool at_from = false;
  bool at_to = false;

  bool operator==(const Grading&) const = default;
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

/// True when patches become a grid of quadrilaterals: of convex ones with equal counts on opposite edges.
bool is_quad_grid(const Outline& outline);

/// Of the edge after this corner.
Grading grading_of_edge(const Outline& outline, std::size_t edge);

/// Where point `index` of 0 to `parts` lies on an edge, from 0 to 1. Parts near a graded end grow with their distance
/// r from it as r^(1/2): (1 - cos(pi t)) / 2 with t = index / parts, or 1 - cos(pi t / 2) where one end is graded.
double share_of_edge(std::uint32_t index, std::uint32_t parts, Grading grading);

/// Point `index` of 0 to `parts` on an edge. Taken from the end that comes first, so that it has the same bits
/// whichever way the edge is traversed.
Point edge_point(const Point& from, const Point& to, std::uint32_t index, std::uint32_t parts, Grading grading = {});

/// All boundary points in the order of PolygonMesh.
std::vector<Point> boundary_points(const Outline& outline);

}  // namespace patchlight
