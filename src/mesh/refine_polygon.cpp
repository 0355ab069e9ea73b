#include "mesh/refine_polygon.h"

#include "patchlight/base/sampling.h"
#include "patchlight/scene/triangulate.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <cmath>
#include <queue>
#include <vector>

namespace patchlight {
namespace {

using Workbench = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;
using OpenMesh::EdgeHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

// Twice the signed area of a triangle in the plane z = 0.
double turn(const Workbench::Point& a, const Workbench::Point& b, const Workbench::Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double dot(const Workbench::Point& a, const Workbench::Point& b, const Workbench::Point& c) {
  return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
}

// The triangles of one polygon in its plane, and the inner edges that are too long.
class Refinement {
 public:
  Refinement(const Outline& outline, const Eigen::Matrix3d& frame, double max_edge);

  void make_delaunay();
  void cut_boundary();
  void split_long_edges();
  PolygonMesh result(const Point& origin, const Eigen::Matrix3d& frame) const;

 private:
  struct LongEdge {
    std::int64_t length;  // as rounded by rounded_length()
    EdgeHandle edge;
    // The longest on top, of equal ones the one with the lowest index.
    bool operator<(const LongEdge& other) const {
      return length != other.length ? length < other.length : edge.idx() > other.edge.idx();
    }
  };

  double squared_length(EdgeHandle edge) const;
  std::int64_t rounded_length(EdgeHandle edge) const;
  void remember_if_long(EdgeHandle edge);
  bool must_flip(EdgeHandle edge) const;
  void flip_suspects();
  void split(EdgeHandle edge, VertexHandle at);

  Workbench mesh_;
  double max_square_;
  std::size_t boundary_count_;
  std::vector<EdgeHandle> suspects_;  // edges that may violate the Delaunay condition
  std::priority_queue<LongEdge> long_edges_;
};

Refinement::Refinement(const Outline& outline, const Eigen::Matrix3d& frame, double max_edge)
    : max_square_(max_edge * max_edge) {
  const std::vector<Point> boundary = boundary_points(outline);
  boundary_count_ = boundary.size();
  for (const Point& point : boundary) {
    const Vector flat = frame.transpose() * (point - outline.corners[0]);
    mesh_.add_vertex({flat.x(), flat.y(), 0});
  }
  std::vector<VertexHandle> corners;
  std::uint32_t next = 0;
  for (const std::uint32_t parts : outline.parts) corners.push_back(mesh_.vertex_handle(next)), next += parts;
  for (const auto& [a, b, c] : triangulate(outline.corners)) mesh_.add_face(corners[a], corners[b], corners[c]);
}

double Refinement::squared_length(EdgeHandle edge) const {
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  const auto& from = mesh_.point(mesh_.from_vertex_handle(h));
  const auto& to = mesh_.point(mesh_.to_vertex_handle(h));
  return dot(from, to, to);
}

// 2^20 log2 of the squared length in units of max_edge: lengths that differ by rounding only come out equal, so that a
// turned polygon is split in the same order.
std::int64_t Refinement::rounded_length(EdgeHandle edge) const {
  return std::llround(0x1p20 * std::log2(squared_length(edge) / max_square_));
}

// An edge of max_edge but for rounding is not too long.
void Refinement::remember_if_long(EdgeHandle edge) {
  constexpr double rounding = 1e-9;
  if (mesh_.is_boundary(edge) || squared_length(edge) <= (1 + rounding) * max_square_) return;
  long_edges_.push({rounded_length(edge), edge});
}

// Is the sum of the angles opposite to the edge above 180 degrees, and do the edge's two triangles form a strictly
// convex quadrilateral? The tolerances keep rounding from flipping an edge to and fro.
bool Refinement::must_flip(EdgeHandle edge) const {
  constexpr double angle_tolerance = 1e-9;
  constexpr double convex_tolerance = 1e-14;
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  const auto& p = mesh_.point(mesh_.from_vertex_handle(h));
  const auto& q = mesh_.point(mesh_.to_vertex_handle(h));
  const auto& a = mesh_.point(mesh_.opposite_vh(h));
  const auto& b = mesh_.point(mesh_.opposite_vh(mesh_.opposite_halfedge_handle(h)));
  const double sin_a = turn(a, p, q), cos_a = dot(a, p, q);
  const double sin_b = turn(b, q, p), cos_b = dot(b, q, p);
  const double scale = std::sqrt(dot(a, p, p) * dot(a, q, q) * dot(b, p, p) * dot(b, q, q));
  if (sin_a * cos_b + cos_a * sin_b >= -angle_tolerance * scale) return false;
  const double smallest = convex_tolerance * dot(a, b, b);
  return turn(a, p, b) > smallest && turn(b, q, a) > smallest;
}

// Lawson 1977.
void Refinement::flip_suspects() {
  while (!suspects_.empty()) {
    const EdgeHandle edge = suspects_.back();
    suspects_.pop_back();
    if (mesh_.is_boundary(edge) || !must_flip(edge) || !mesh_.is_flip_ok(edge)) continue;
    mesh_.flip(edge);
    remember_if_long(edge);
    for (const int side : {0, 1}) {
      const HalfedgeHandle h = mesh_.halfedge_handle(edge, side);
      suspects_.push_back(mesh_.edge_handle(mesh_.next_halfedge_handle(h)));
      suspects_.push_back(mesh_.edge_handle(mesh_.prev_halfedge_handle(h)));
    }
  }
}

void Refinement::make_delaunay() {
  for (const EdgeHandle edge : mesh_.edges()) suspects_.push_back(edge);
  flip_suspects();
}

void Refinement::split(EdgeHandle edge, VertexHandle at) {
  mesh_.split(edge, at);
  for (const auto spoke : mesh_.voh_range(at)) {
    remember_if_long(spoke.edge());
    if (!spoke.is_boundary()) suspects_.push_back(spoke.next().edge());
  }
  flip_suspects();
}

// Halves the boundary edges, longest first, until every boundary point is in: an edge from point i to j > i, where the
// first point also ends the last edge, is cut at (i + j) / 2.
void Refinement::cut_boundary() {
  std::priority_queue<LongEdge> uncut;
  for (const EdgeHandle edge : mesh_.edges()) {
    if (mesh_.is_boundary(edge)) uncut.push({rounded_length(edge), edge});
  }
  while (!uncut.empty()) {
    const EdgeHandle edge = uncut.top().edge;
    uncut.pop();
    const HalfedgeHandle outer = mesh_.halfedge_handle(edge, mesh_.is_boundary(mesh_.halfedge_handle(edge, 0)) ? 0 : 1);
    const int from = mesh_.to_vertex_handle(outer).idx();
    const int end = mesh_.from_vertex_handle(outer).idx();
    const int to = end == 0 ? static_cast<int>(boundary_count_) : end;
    if (to - from < 2) continue;
    const VertexHandle middle((from + to) / 2);
    split(edge, middle);
    for (const auto spoke : mesh_.voh_range(middle)) {
      if (spoke.edge().is_boundary()) uncut.push({rounded_length(spoke.edge()), spoke.edge()});
    }
  }
}

void Refinement::split_long_edges() {
  for (const EdgeHandle edge : mesh_.edges()) remember_if_long(edge);
  while (!long_edges_.empty()) {
    const auto [length, edge] = long_edges_.top();
    long_edges_.pop();
    // An edge that was split or flipped since has another length and its own entry.
    if (rounded_length(edge) != length) continue;
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const auto middle = 0.5 * (mesh_.point(mesh_.from_vertex_handle(h)) + mesh_.point(mesh_.to_vertex_handle(h)));
    split(edge, mesh_.add_vertex(middle));
  }
}

PolygonMesh Refinement::result(const Point& origin, const Eigen::Matrix3d& frame) const {
  PolygonMesh result;
  for (std::size_t v = boundary_count_; v < mesh_.n_vertices(); ++v) {
    const auto& point = mesh_.point(mesh_.vertex_handle(static_cast<unsigned>(v)));
    result.inner.push_back(origin + frame.leftCols<2>() * Eigen::Vector2d(point[0], point[1]));
  }
  result.patches.reserve(mesh_.n_faces());
  for (const auto face : mesh_.faces()) {
    std::array<std::uint32_t, 4> patch{};
    std::size_t k = 0;
    for (const auto vertex : mesh_.fv_range(face)) patch[k++] = static_cast<std::uint32_t>(vertex.idx());
    patch[3] = patch[2];
    result.patches.push_back(patch);
  }
  return result;
}

}  // namespace

PolygonMesh refine_polygon(const Outline& outline, double max_edge) {
  const Eigen::Matrix3d frame = frame_around(outline.normal);
  Refinement refinement(outline, frame, max_edge);
  refinement.make_delaunay();
  refinement.cut_boundary();
  refinement.split_long_edges();
  return refinement.result(outline.corners[0], frame);
}

}  // namespace patchlight
