#pragma once

#include "mesh/noded_lines.h"
#include "mesh/outline.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// The patches of one polygon: a grid of quadrilaterals or triangles where the outline allows it, else a Delaunay mesh,
/// see tessellate().
PolygonMesh mesh_polygon(const Outline& outline, double max_edge);

/// How many patches that has.
std::size_t count_patches(const Outline& outline, double max_edge);

/// The longest edge of each of them, meters.
std::vector<double> longest_edges(const Outline& outline, double max_edge);

/// The polygon's plane: the origin is the beginning of its longest edge, the axes are that edge's direction, the one to
/// its left, and the normal.
struct OutlinePlane {
  Point origin;
  Eigen::Matrix3d axes;
  double spacing;  ///< of the points on that edge
  bool is_cut;     ///< that edge: it has points besides its ends

  FlatPoint flat(const Point& point) const { return axes.leftCols<2>().transpose() * (point - origin); }
  Point lifted(const FlatPoint& point) const { return origin + axes.leftCols<2>() * point; }
};

/// Points inside a polygon, in its plane: those of each line, in parts, and those of each row of a lattice.
struct InnerPoints {
  std::vector<std::vector<FlatPoint>> lines, lattice;
};

/// A Delaunay mesh of triangles with these points, split at the longest inner edge until none is longer than
/// `max_edge`. Only edges that are parts of lines need not be Delaunay.
PolygonMesh delaunay_mesh(const Outline& outline, const OutlinePlane& plane, double max_edge, const InnerPoints& inner);

}  // namespace patchlight
