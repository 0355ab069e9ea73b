#pragma once

#include "patchlight/scene/scene.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace patchlight {

/// Polygons whose normals are nearer to each other than 30 degrees go on over a common edge: its cosine.
inline constexpr double smooth_cosine = std::numbers::sqrt3 / 2;

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

/// The number of parts of an edge for which no part is longer than `max_edge`.
std::uint32_t parts_of(const Point& from, const Point& to, double max_edge);

Outline make_outline(std::vector<Point> corners, const Vector& normal, double max_edge);

/// True when patches become a grid of quadrilaterals: of convex ones with equal counts on opposite edges.
bool is_quad_grid(const Outline& outline);

/// The grading of the edge after this corner.
Grading grading_of_edge(const Outline& outline, std::size_t edge);

/// Where point `index` of 0 to `parts` lies on an edge, from 0 to 1. Parts near a graded end grow with their distance
/// r from it as r^(1/2): (1 - cos(pi t)) / 2 with t = index / parts, or 1 - cos(pi t / 2) where one end is graded.
double share_of_edge(std::uint32_t index, std::uint32_t parts, Grading grading);

/// Point `index` of 0 to `parts` on an edge. Taken from the end that comes first, so that it has the same bits
/// whichever way the edge is traversed.
Point edge_point(const Point& from, const Point& to, std::uint32_t index, std::uint32_t parts, Grading grading = {});

/// All boundary points in the order of PolygonMesh.
std::vector<Point> boundary_points(const Outline& outline);

/// The longest edge of the patches of each polygon, meters.
struct PatchEdges {
  double max_edge = 0;
  std::vector<double> coarsest = {};  ///< per polygon: a longer edge that its patches may have; empty: none

  PatchEdges(double edge) : max_edge(edge) {}  // NOLINT(google-explicit-constructor): one edge for all polygons
  PatchEdges(double edge, std::vector<double> of_polygons) : max_edge(edge), coarsest(std::move(of_polygons)) {}

  double on(std::size_t polygon) const { return coarsest.empty() ? max_edge : std::max(max_edge, coarsest[polygon]); }
};

/// Where the edges of an outline are finer than patches, patches follow fewer corners: none of the outline is farther
/// from theirs than this share of the longest patch edge, or of the narrowest face there if that is less.
inline constexpr double outline_tolerance = 0.01;

/// Whether patches could do without a corner.
struct LooseCorner {
  double width = 0;       ///< 4 area / perimeter of the narrowest face that has it, in meters; 0: the corner is kept
  bool reversed = false;  ///< the first face that has it goes through it the other way
};

/// Per polygon and corner of outline_corners(). A polygon without loose corners has an empty list; when no polygon has
/// any, there are no lists.
using LooseCorners = std::vector<std::vector<LooseCorner>>;

/// The corners of a polygon, no two consecutive ones at one place.
std::vector<Point> outline_corners(const Scene& scene, PolygonIndex polygon);

/// Finds loose corners: corners of outlines with over 24 corners, where the outline turns by at most 15 degrees. They
/// belong to one face alone, or to two faces between the same neighbors. Positions are compared bit by bit. O(n log n).
LooseCorners find_loose_corners(const Scene& scene);

/// The corners that the patches of a polygon follow. Runs of loose corners between two kept ones become coarser, if all
/// edges are shorter than `max_edge` and the face is wide. The chords turn by at most 30 degrees each. Corners are
/// moved to keep the area on either side, up to rounding. Both faces that share the run get the same bits. Returns all
/// corners if the coarser outline would cross itself.
std::vector<Point> coarse_outline(const Scene& scene, const LooseCorners& loose, PolygonIndex polygon, double max_edge);

}  // namespace patchlight
