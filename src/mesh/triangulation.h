#pragma once

#include "mesh/noded_lines.h"
#include "mesh/outline.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <vector>

namespace patchlight {

using Workbench = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;
using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

/// Twice the signed area of a triangle in the plane z = 0.
inline double turn(const Workbench::Point& a, const Workbench::Point& b, const Workbench::Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// (b - a) . (c - a) there.
inline double dot(const Workbench::Point& a, const Workbench::Point& b, const Workbench::Point& c) {
  return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
}

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

/// The triangles of one polygon in its plane, and the inner edges that are too long. Delaunay, but for edges that are
/// parts of lines.
class Triangulation {
 public:
  Triangulation(const Outline& outline, const OutlinePlane& plane, double max_edge);

  void make_delaunay();
  void cut_boundary();
  void insert_lines(std::span<const std::vector<FlatPoint>> lines);
  void insert_rows(const std::vector<std::vector<FlatPoint>>& rows);
  void split_long_edges();
  PolygonMesh result(const OutlinePlane& plane) const;

 private:
  struct LongEdge {
    std::int64_t length;  // as rounded by rounded_length()
    EdgeHandle edge;
    // The longest on top, of equal ones the one with the lowest index.
    bool operator<(const LongEdge& other) const {
      return length != other.length ? length < other.length : edge.idx() > other.edge.idx();
    }
  };

  struct CornerNumbers {
    std::vector<std::uint32_t> of_halfedge;  // the number of the vertex that it begins at, for its face
    std::vector<VertexHandle> copies;        // the vertices of the numbers after those of the mesh
  };

  double squared_length(EdgeHandle edge) const;
  std::int64_t rounded_length(EdgeHandle edge) const;
  void remember_if_long(EdgeHandle edge);
  bool must_flip(EdgeHandle edge) const;
  bool can_flip(EdgeHandle edge) const;
  void flip(EdgeHandle edge);
  void flip_suspects();
  void split(EdgeHandle edge, VertexHandle at);
  bool is_left_of(HalfedgeHandle edge, const Workbench::Point& point) const;
  bool is_flat(FaceHandle face) const;
  FaceHandle find_face(FaceHandle start, const Workbench::Point& point) const;
  bool is_line(EdgeHandle edge) const;
  void mark_as_line(EdgeHandle edge);
  VertexHandle insert_point(FaceHandle start, const Workbench::Point& point);
  std::optional<std::vector<EdgeHandle>> edges_across(VertexHandle from, VertexHandle to) const;
  bool make_edge(VertexHandle from, VertexHandle to);
  std::vector<EdgeHandle> edges_in_quadrilaterals() const;
  std::vector<HalfedgeHandle> halfedges_around(VertexHandle vertex) const;
  bool first_keeps(const std::vector<HalfedgeHandle>& around, const OutlinePlane& plane) const;
  CornerNumbers corner_numbers(const OutlinePlane& plane) const;

  Workbench mesh_;
  double max_square_;
  std::size_t boundary_count_;
  double rounding_ = 0;                // of points, metres
  std::vector<std::uint8_t> is_line_;  // per edge, shorter where the last ones are none: part of a line, never flipped
  std::vector<EdgeHandle> suspects_;   // edges that may violate the Delaunay condition
  std::priority_queue<LongEdge> long_edges_;
};

}  // namespace patchlight
