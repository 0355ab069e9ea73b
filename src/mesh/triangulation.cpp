#include "base/tolerances.h"
#include "mesh/polygon_mesh.h"
#include "scene/triangulate.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <queue>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using Workbench = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;
using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

// Twice the signed area of a triangle in the plane z = 0.
double turn(const Workbench::Point& a, const Workbench::Point& b, const Workbench::Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// (b - a) . (c - a) there.
double dot(const Workbench::Point& a, const Workbench::Point& b, const Workbench::Point& c) {
  return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
}

// The corners of a quadrilateral, counterclockwise.
using Corners = std::array<Workbench::Point, 4>;

// Does it turn left at its first and third corner, by more than this share of the square between the others?
bool is_convex(const Corners& corners, double share) {
  const auto& [p, b, q, a] = corners;
  const double smallest = share * dot(a, b, b);
  return turn(a, p, b) > smallest && turn(b, q, a) > smallest;
}

// The triangles of one polygon in its plane, and the inner edges that are too long. Delaunay, but for edges that are
// parts of lines.
class Triangulation {
 public:
  Triangulation(const Outline& outline, const OutlinePlane& plane, double max_edge);

  void cut_boundary();
  void insert_lines(std::span<const std::vector<FlatPoint>> lines);
  void insert_rows(const std::vector<std::vector<FlatPoint>>& rows);
  void split_long_edges();
  PolygonMesh result(const OutlinePlane& plane) const;

 private:
  // The rounded_length() and minus the index: the longest edge is on top, of equal ones that with the lowest index.
  using LongEdge = std::pair<std::int64_t, int>;

  struct CornerNumbers {
    std::vector<std::uint32_t> of_halfedge;  // the number of the vertex that it begins at, for its face
    std::vector<VertexHandle> copies;        // the vertices of the numbers after those of the mesh
  };

  LongEdge long_edge(EdgeHandle edge) const { return {rounded_length(edge), -edge.idx()}; }
  std::int64_t rounded_length(EdgeHandle edge) const;
  void remember_if_long(EdgeHandle edge);
  Corners corners_around(EdgeHandle edge) const;
  bool must_flip(EdgeHandle edge) const;
  bool can_flip(EdgeHandle edge) const;
  void flip(EdgeHandle edge);
  void flip_suspects();
  void split(EdgeHandle edge, VertexHandle at);
  bool is_left_of(HalfedgeHandle edge, const Workbench::Point& point) const;
  bool is_flat(FaceHandle face) const;
  FaceHandle find_face(FaceHandle face, const Workbench::Point& point) const;
  bool is_line(EdgeHandle edge) const;
  void mark_as_line(EdgeHandle edge);
  VertexHandle insert_point(FaceHandle start, const Workbench::Point& point);
  std::vector<EdgeHandle> edges_across(VertexHandle from, VertexHandle to) const;
  bool make_edge(VertexHandle from, VertexHandle to);
  std::vector<EdgeHandle> edges_in_quadrilaterals() const;
  std::vector<HalfedgeHandle> halfedges_around(VertexHandle vertex) const;
  bool first_keeps(const std::vector<HalfedgeHandle>& around, const OutlinePlane& plane) const;
  CornerNumbers corner_numbers(const OutlinePlane& plane) const;

  Workbench mesh_;
  double max_square_;
  std::size_t boundary_count_;
  double rounding_ = 0;                // of points, meters
  std::vector<std::uint8_t> is_line_;  // per edge, shorter where the last ones are none: part of a line, never flipped
  std::vector<EdgeHandle> suspects_;   // edges that may violate the Delaunay condition
  std::priority_queue<LongEdge> long_edges_;
};

// A place as a key: ends of lines have the same bits as corners of the outline and ends of other lines.
std::array<double, 2> place_of(const FlatPoint& point) { return {point.x(), point.y()}; }

// Sorts patches by their corners, so that their order does not depend on the sequence of flipped edges.
void put_in_order(std::vector<std::array<std::uint32_t, 4>>& patches) {
  for (auto& patch : patches) {
    const auto end = patch.begin() + (patch[2] == patch[3] ? 3 : 4);
    std::rotate(patch.begin(), std::min_element(patch.begin(), end), end);
    if (end != patch.end()) patch[3] = patch[2];
  }
  std::sort(patches.begin(), patches.end());
}

// The largest cosine of an angle at a corner, either way: 0 for a rectangle; 1 of one that is not convex.
double skewness(const Corners& corners) {
  double largest = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& at = corners[k];
    const auto& before = corners[(k + 3) % 4];
    const auto& after = corners[(k + 1) % 4];
    if (turn(before, at, after) <= 0) return 1;
    largest = std::max(largest,
                       std::abs(dot(at, before, after)) / std::sqrt(dot(at, before, before) * dot(at, after, after)));
  }
  return largest;
}

Triangulation::Triangulation(const Outline& outline, const OutlinePlane& plane, double max_edge)
    : max_square_(max_edge * max_edge) {
  const std::vector<Point> boundary = boundary_points(outline);
  boundary_count_ = boundary.size();
  // Eight roundings of the coordinates and of the plane's axes.
  for (const Point& corner : outline.corners)
    rounding_ = std::max(rounding_, 8 * std::numeric_limits<double>::epsilon() * corner.cwiseAbs().maxCoeff());
  for (const Point& point : boundary) {
    const FlatPoint flat = plane.flat(point);
    mesh_.add_vertex({flat.x(), flat.y(), 0});
  }
  std::vector<VertexHandle> corners;
  std::uint32_t next = 0;
  for (const std::uint32_t parts : outline.parts) corners.push_back(mesh_.vertex_handle(next)), next += parts;
  for (const auto& [a, b, c] : triangulate(outline.corners)) mesh_.add_face(corners[a], corners[b], corners[c]);
  for (const EdgeHandle edge : mesh_.edges()) suspects_.push_back(edge);
  flip_suspects();
}

// 2^20 log2 of the squared length in units of max_edge: lengths that differ by rounding only come out equal, so that a
// turned polygon is split in the same order.
std::int64_t Triangulation::rounded_length(EdgeHandle edge) const {
  return std::llround(0x1p20 * std::log2(mesh_.calc_edge_sqr_length(edge) / max_square_));
}

// An edge of max_edge but for rounding is not too long.
void Triangulation::remember_if_long(EdgeHandle edge) {
  if (mesh_.is_boundary(edge) || mesh_.calc_edge_sqr_length(edge) <= (1 + tolerance_of_shapes) * max_square_) return;
  long_edges_.push(long_edge(edge));
}

// The ends of an inner edge and the corners opposite to it in turn, counter-clockwise.
Corners Triangulation::corners_around(EdgeHandle edge) const {
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  return {mesh_.point(mesh_.from_vertex_handle(h)), mesh_.point(mesh_.opposite_vh(mesh_.opposite_halfedge_handle(h))),
          mesh_.point(mesh_.to_vertex_handle(h)), mesh_.point(mesh_.opposite_vh(h))};
}

// Is the sum of the angles opposite to the edge above 180 degrees, and do the edge's two triangles form a strictly
// convex quadrilateral? The tolerances keep rounding from flipping an edge to and fro.
bool Triangulation::must_flip(EdgeHandle edge) const {
  // Corners of narrow strips beside lines know their angles less well.
  const double angle_tolerance = is_line_.empty() ? 1e-9 : 1e-6;
  const auto [p, b, q, a] = corners_around(edge);
  const double sin_a = turn(a, p, q), cos_a = dot(a, p, q);
  const double sin_b = turn(b, q, p), cos_b = dot(b, q, p);
  const double scale = std::sqrt(dot(a, p, p) * dot(a, q, q) * dot(b, p, p) * dot(b, q, q));
  if (sin_a * cos_b + cos_a * sin_b >= -angle_tolerance * scale) return false;
  return is_convex({p, b, q, a}, 1e-14);
}

// Are the two vertices opposite to the edge not joined yet? Around both at once, as one may have very many neighbors.
bool Triangulation::can_flip(EdgeHandle edge) const {
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  const VertexHandle a = mesh_.opposite_vh(h);
  const VertexHandle b = mesh_.opposite_vh(mesh_.opposite_halfedge_handle(h));
  auto around_a = mesh_.cvv_iter(a);
  auto around_b = mesh_.cvv_iter(b);
  for (; around_a.is_valid() && around_b.is_valid(); ++around_a, ++around_b) {
    if (*around_a == b || *around_b == a) return false;
  }
  return a != b;
}

// As OpenMesh does it, which first goes around a vertex that may have very many neighbors.
void Triangulation::flip(EdgeHandle edge) {
  const HalfedgeHandle a0 = mesh_.halfedge_handle(edge, 0);
  const HalfedgeHandle b0 = mesh_.halfedge_handle(edge, 1);
  const HalfedgeHandle a1 = mesh_.next_halfedge_handle(a0);
  const HalfedgeHandle a2 = mesh_.next_halfedge_handle(a1);
  const HalfedgeHandle b1 = mesh_.next_halfedge_handle(b0);
  const HalfedgeHandle b2 = mesh_.next_halfedge_handle(b1);
  const VertexHandle to_a = mesh_.to_vertex_handle(a0);
  const VertexHandle to_b = mesh_.to_vertex_handle(b0);
  const FaceHandle face_a = mesh_.face_handle(a0);
  const FaceHandle face_b = mesh_.face_handle(b0);
  mesh_.set_vertex_handle(a0, mesh_.to_vertex_handle(a1));
  mesh_.set_vertex_handle(b0, mesh_.to_vertex_handle(b1));
  for (const auto& [one, next] : {std::pair{a0, a2}, {a2, b1}, {b1, a0}, {b0, b2}, {b2, a1}, {a1, b0}})
    mesh_.set_next_halfedge_handle(one, next);
  mesh_.set_face_handle(a1, face_b);
  mesh_.set_face_handle(b1, face_a);
  mesh_.set_halfedge_handle(face_a, a0);
  mesh_.set_halfedge_handle(face_b, b0);
  if (mesh_.halfedge_handle(to_a) == b0) mesh_.set_halfedge_handle(to_a, a1);
  if (mesh_.halfedge_handle(to_b) == a0) mesh_.set_halfedge_handle(to_b, b1);
}

// Lawson 1977.
void Triangulation::flip_suspects() {
  while (!suspects_.empty()) {
    const EdgeHandle edge = suspects_.back();
    suspects_.pop_back();
    if (mesh_.is_boundary(edge) || is_line(edge) || !must_flip(edge) || !can_flip(edge)) continue;
    flip(edge);
    remember_if_long(edge);
    for (const int side : {0, 1}) {
      const HalfedgeHandle h = mesh_.halfedge_handle(edge, side);
      suspects_.push_back(mesh_.edge_handle(mesh_.next_halfedge_handle(h)));
      suspects_.push_back(mesh_.edge_handle(mesh_.prev_halfedge_handle(h)));
    }
  }
}

void Triangulation::split(EdgeHandle edge, VertexHandle at) {
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  const std::array<VertexHandle, 2> ends{mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h)};
  const bool of_line = is_line(edge);
  mesh_.split(edge, at);
  for (const VertexHandle end : ends)
    if (of_line) mark_as_line(mesh_.edge_handle(mesh_.find_halfedge(at, end)));
  for (const auto spoke : mesh_.voh_range(at)) {
    remember_if_long(spoke.edge());
    if (!spoke.is_boundary()) suspects_.push_back(spoke.next().edge());
  }
  flip_suspects();
}

// Halves the boundary edges, longest first, until every boundary point is in: an edge from point i to j > i, where the
// first point also ends the last edge, is cut at (i + j) / 2.
void Triangulation::cut_boundary() {
  std::priority_queue<LongEdge> uncut;
  for (const EdgeHandle edge : mesh_.edges()) {
    if (mesh_.is_boundary(edge)) uncut.push(long_edge(edge));
  }
  while (!uncut.empty()) {
    const EdgeHandle edge(-uncut.top().second);
    uncut.pop();
    const HalfedgeHandle outer = mesh_.halfedge_handle(edge, mesh_.is_boundary(mesh_.halfedge_handle(edge, 0)) ? 0 : 1);
    const int from = mesh_.to_vertex_handle(outer).idx();
    const int end = mesh_.from_vertex_handle(outer).idx();
    const int to = end == 0 ? static_cast<int>(boundary_count_) : end;
    if (to - from < 2) continue;
    const VertexHandle middle((from + to) / 2);
    split(edge, middle);
    for (const auto spoke : mesh_.voh_range(middle)) {
      if (spoke.edge().is_boundary()) uncut.push(long_edge(spoke.edge()));
    }
  }
}

// A point on the edge but for rounding counts as left of it.
bool Triangulation::is_left_of(HalfedgeHandle edge, const Workbench::Point& point) const {
  const auto& from = mesh_.point(mesh_.from_vertex_handle(edge));
  const auto& to = mesh_.point(mesh_.to_vertex_handle(edge));
  return turn(from, to, point) >= -tolerance_of_shapes * std::sqrt(dot(from, to, to) * max_square_);
}

// Walks from triangle to triangle toward the point. Where the boundary of a concave polygon is in the way, every
// triangle is tried.
FaceHandle Triangulation::find_face(FaceHandle face, const Workbench::Point& point) const {
  const auto exit_of = [&](FaceHandle from) {
    for (const auto edge : mesh_.fh_range(from)) {
      if (!is_left_of(edge, point)) return HalfedgeHandle(edge);
    }
    return HalfedgeHandle();
  };
  for (std::size_t step = 0; face.is_valid() && step < mesh_.n_faces(); ++step) {
    const HalfedgeHandle exit = exit_of(face);
    if (!exit.is_valid()) return face;
    face = mesh_.opposite_face_handle(exit);
  }
  for (const FaceHandle any : mesh_.faces()) {
    if (!exit_of(any).is_valid()) return any;
  }
  return FaceHandle();
}

void Triangulation::insert_rows(const std::vector<std::vector<FlatPoint>>& rows) {
  struct Known {
    double x;
    FaceHandle face;
  };
  std::vector<Known> last_row{{0, FaceHandle(0)}};
  for (const std::vector<FlatPoint>& row : rows) {
    std::vector<Known> this_row;
    std::size_t below = 0;
    for (const FlatPoint& flat : row) {
      // Begin at the face of the nearest point of the last row.
      while (below + 1 < last_row.size() && last_row[below].x < flat.x()) ++below;
      const Workbench::Point point(flat.x(), flat.y(), 0);
      const FaceHandle face = find_face(last_row[below].face, point);
      if (!face.is_valid()) continue;
      this_row.push_back({flat.x(), face});
      for (const auto edge : mesh_.fe_range(face)) suspects_.push_back(edge);
      mesh_.split(face, mesh_.add_vertex(point));
      flip_suspects();
    }
    if (!this_row.empty()) last_row = std::move(this_row);
  }
}

void Triangulation::split_long_edges() {
  long_edges_ = {};
  for (const EdgeHandle edge : mesh_.edges()) remember_if_long(edge);
  while (!long_edges_.empty()) {
    const auto [length, minus_index] = long_edges_.top();
    const EdgeHandle edge(-minus_index);
    long_edges_.pop();
    // An edge that was split or flipped since has another length and its own entry.
    if (rounded_length(edge) != length) continue;
    split(edge, mesh_.add_vertex(mesh_.calc_edge_midpoint(edge)));
  }
}

bool Triangulation::is_line(EdgeHandle edge) const {
  const auto place = static_cast<std::size_t>(edge.idx());
  return place < is_line_.size() && is_line_[place] != 0;
}

void Triangulation::mark_as_line(EdgeHandle edge) {
  const auto place = static_cast<std::size_t>(edge.idx());
  if (place >= is_line_.size()) is_line_.resize(mesh_.n_edges(), 0);
  is_line_[place] = 1;
}

// A point on an edge but for rounding cuts that, any other the triangle it lies in. Invalid where it lies in none.
VertexHandle Triangulation::insert_point(FaceHandle start, const Workbench::Point& point) {
  const FaceHandle face = find_face(start, point);
  if (!face.is_valid()) return VertexHandle();
  for (const auto h : mesh_.fh_range(face)) {
    const auto& from = mesh_.point(mesh_.from_vertex_handle(h));
    const auto& to = mesh_.point(mesh_.to_vertex_handle(h));
    if (std::abs(turn(from, to, point)) > tolerance_of_shapes * std::sqrt(dot(from, to, to) * max_square_)) continue;
    if (mesh_.is_boundary(mesh_.edge_handle(h))) return VertexHandle();
    const VertexHandle vertex = mesh_.add_vertex(point);
    split(mesh_.edge_handle(h), vertex);
    return vertex;
  }
  for (const auto edge : mesh_.fe_range(face)) suspects_.push_back(edge);
  const VertexHandle vertex = mesh_.add_vertex(point);
  mesh_.split(face, vertex);
  flip_suspects();
  return vertex;
}

// The edges between two vertices, from the first to the second. Nothing where the boundary or a third vertex is in the
// way.
std::vector<EdgeHandle> Triangulation::edges_across(VertexHandle from, VertexHandle to) const {
  const auto& start = mesh_.point(from);
  const auto& end = mesh_.point(to);
  const auto side = [&](VertexHandle vertex) { return turn(start, end, mesh_.point(vertex)); };

  // 1. The triangle at the first vertex through which the way begins.
  HalfedgeHandle crossed;
  for (const auto h : mesh_.voh_range(from)) {
    if (mesh_.is_boundary(h)) continue;
    const HalfedgeHandle opposite = mesh_.next_halfedge_handle(h);
    if (side(mesh_.from_vertex_handle(opposite)) < 0 && side(mesh_.to_vertex_handle(opposite)) > 0 &&
        turn(start, mesh_.point(mesh_.from_vertex_handle(opposite)), end) > 0)
      crossed = opposite;
  }

  // 2. From triangle to triangle.
  std::vector<EdgeHandle> edges;
  while (crossed.is_valid()) {
    edges.push_back(mesh_.edge_handle(crossed));
    const HalfedgeHandle beyond = mesh_.opposite_halfedge_handle(crossed);
    if (mesh_.is_boundary(beyond) || edges.size() > mesh_.n_edges()) return {};
    const HalfedgeHandle left = mesh_.next_halfedge_handle(beyond);
    const VertexHandle apex = mesh_.to_vertex_handle(left);
    if (apex == to) return edges;
    const double apex_side = side(apex);
    if (apex_side == 0) return {};
    crossed = apex_side < 0 ? mesh_.next_halfedge_handle(left) : left;
  }
  return {};
}

// Flips crossing edges until the edge exists: Sloan 1993, section 3.
bool Triangulation::make_edge(VertexHandle from, VertexHandle to) {
  if (const HalfedgeHandle there = mesh_.find_halfedge(from, to); there.is_valid()) {
    if (!mesh_.is_boundary(mesh_.edge_handle(there))) mark_as_line(mesh_.edge_handle(there));
    return true;
  }
  const std::vector<EdgeHandle> across = edges_across(from, to);
  const auto is_fixed = [&](EdgeHandle edge) { return is_line(edge); };
  if (across.empty() || std::any_of(across.begin(), across.end(), is_fixed)) return false;
  const auto& start = mesh_.point(from);
  const auto& end = mesh_.point(to);
  const auto crosses = [&](EdgeHandle edge) {
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const VertexHandle a = mesh_.from_vertex_handle(h);
    const VertexHandle b = mesh_.to_vertex_handle(h);
    if (a == from || a == to || b == from || b == to) return false;
    const double at_a = turn(start, end, mesh_.point(a));
    const double at_b = turn(start, end, mesh_.point(b));
    const double nothing = tolerance_of_shapes * max_square_;
    return (at_a > nothing && at_b < -nothing) || (at_a < -nothing && at_b > nothing);
  };

  std::deque<EdgeHandle> left(across.begin(), across.end());
  std::vector<EdgeHandle> flipped;
  std::size_t tries = 10 + 2 * left.size() * left.size();
  for (; !left.empty() && tries > 0; --tries) {
    const EdgeHandle edge = left.front();
    left.pop_front();
    if (!is_convex(corners_around(edge), tolerance_of_arithmetic) || !can_flip(edge)) {
      left.push_back(edge);
      continue;
    }
    flip(edge);
    flipped.push_back(edge);
    if (crosses(edge)) left.push_back(edge);
  }
  const HalfedgeHandle made = mesh_.find_halfedge(from, to);
  if (made.is_valid()) mark_as_line(mesh_.edge_handle(made));
  for (const EdgeHandle edge : flipped) remember_if_long(edge);
  suspects_.insert(suspects_.end(), flipped.begin(), flipped.end());
  flip_suspects();
  return made.is_valid();
}

// Inserts each part of a line as an edge if possible; elsewhere patches cross the line.
void Triangulation::insert_lines(std::span<const std::vector<FlatPoint>> lines) {
  if (lines.empty()) return;
  std::map<std::array<double, 2>, std::vector<VertexHandle>> vertices;
  for (const auto vertex : mesh_.vertices())
    vertices[place_of({mesh_.point(vertex)[0], mesh_.point(vertex)[1]})].push_back(vertex);
  FaceHandle near(0);
  for (const std::vector<FlatPoint>& line : lines) {
    for (const FlatPoint& point : line) {
      const auto [known, is_new] = vertices.try_emplace(place_of(point));
      if (!is_new) continue;
      const VertexHandle vertex = insert_point(near, {point.x(), point.y(), 0});
      if (!vertex.is_valid()) continue;
      known->second.push_back(vertex);
      near = *mesh_.cvf_iter(vertex);
    }
  }
  for (const std::vector<FlatPoint>& line : lines) {
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      // Where a seam goes through a place there are several vertices, of which one can be reached.
      bool made = false;
      for (const VertexHandle from : vertices[place_of(line[k])])
        for (const VertexHandle to : vertices[place_of(line[k + 1])]) made = made || make_edge(from, to);
    }
  }
}

// Is the triangle no more than a line but for rounding, or turned over? It then covers nothing, or what others do: at a
// corner of the polygon that lies on an edge, at the end of a line beside one or, by rounding, beyond it.
bool Triangulation::is_flat(FaceHandle face) const {
  std::array<Workbench::Point, 3> corners;
  std::size_t k = 0;
  for (const auto vertex : mesh_.fv_range(face)) corners[k++] = mesh_.point(vertex);
  const auto& [a, b, c] = corners;
  const double squares = dot(a, b, b) + dot(b, c, c) + dot(c, a, a);
  return turn(a, b, c) <= tolerance_of_arithmetic * squares + rounding_ * std::sqrt(squares);
}

// The halfedges that begin at a vertex, counter-clockwise from the boundary or, inside, from a line on.
std::vector<HalfedgeHandle> Triangulation::halfedges_around(VertexHandle vertex) const {
  std::vector<HalfedgeHandle> around;
  for (const auto h : mesh_.voh_ccw_range(vertex)) around.push_back(h);
  const bool on_boundary = mesh_.is_boundary(vertex);
  const auto first = std::find_if(around.begin(), around.end(), [&](HalfedgeHandle h) {
    return on_boundary ? mesh_.is_boundary(mesh_.opposite_halfedge_handle(h)) : is_line(mesh_.edge_handle(h));
  });
  if (first != around.end()) std::rotate(around.begin(), first, around.end());
  return around;
}

// Which of the two boundary edges at a vertex has the patches that keep it, the first or the last one
// counter-clockwise? A neighbor that shares both walks along them the other way, and has the same answer.
bool Triangulation::first_keeps(const std::vector<HalfedgeHandle>& around, const OutlinePlane& plane) const {
  const Vector any_direction(0.8191, 0.5117, 0.2594);
  const auto to_first = mesh_.point(mesh_.to_vertex_handle(around.front()));
  const auto to_last = mesh_.point(mesh_.to_vertex_handle(around.back()));
  return any_direction.dot(plane.lifted({to_first[0], to_first[1]}) - plane.lifted({to_last[0], to_last[1]})) > 0;
}

// Patches on both sides of a line share no vertices: around each, the corners between two lines have a copy of their
// own, but for those that keep it.
Triangulation::CornerNumbers Triangulation::corner_numbers(const OutlinePlane& plane) const {
  CornerNumbers numbers{std::vector<std::uint32_t>(mesh_.n_halfedges()), {}};
  for (const VertexHandle vertex : mesh_.vertices()) {
    std::vector<HalfedgeHandle> around = halfedges_around(vertex);
    const auto is_line_at = [&](HalfedgeHandle h) { return is_line(mesh_.edge_handle(h)); };
    std::size_t fans = 1;
    for (std::size_t k = 1; k < around.size(); ++k) fans += is_line_at(around[k]) ? 1 : 0;
    const bool is_cut_boundary = fans > 1 && mesh_.is_boundary(vertex);
    const std::size_t keeps = is_cut_boundary && !first_keeps(around, plane) ? fans - 1 : 0;
    std::size_t fan = 0;
    std::uint32_t number = 0;
    for (std::size_t k = 0; k < around.size(); ++k) {
      const bool begins = k == 0 || is_line_at(around[k]);
      if (k > 0 && begins) ++fan;
      if (begins && fan == keeps) number = static_cast<std::uint32_t>(vertex.idx());
      if (begins && fan != keeps) {
        number = static_cast<std::uint32_t>(mesh_.n_vertices() + numbers.copies.size());
        numbers.copies.push_back(vertex);
      }
      numbers.of_halfedge[static_cast<std::size_t>(around[k].idx())] = number;
    }
  }
  return numbers;
}

// Pairs of triangles that make a good quadrilateral, the best ones first: each as the edge between them.
std::vector<EdgeHandle> Triangulation::edges_in_quadrilaterals() const {
  std::vector<std::tuple<std::int64_t, std::array<int, 2>, EdgeHandle>> candidates;
  for (const EdgeHandle edge : mesh_.edges()) {
    if (mesh_.is_boundary(edge) || is_line(edge)) continue;
    const double skew = skewness(corners_around(edge));
    if (!(skew <= 0.8)) continue;
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const auto [low, high] = std::minmax({mesh_.from_vertex_handle(h).idx(), mesh_.to_vertex_handle(h).idx()});
    candidates.push_back({std::llround(0x1p20 * skew), {low, high}, edge});
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::uint8_t> is_taken(mesh_.n_faces(), 0);
  std::vector<EdgeHandle> chosen;
  for (const auto& [skew, ends, edge] : candidates) {
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const FaceHandle one = mesh_.face_handle(h);
    const FaceHandle other = mesh_.face_handle(mesh_.opposite_halfedge_handle(h));
    auto& first = is_taken[static_cast<std::size_t>(one.idx())];
    auto& second = is_taken[static_cast<std::size_t>(other.idx())];
    if (first != 0 || second != 0 || is_flat(one) || is_flat(other)) continue;
    first = second = 1;
    chosen.push_back(edge);
  }
  return chosen;
}

PolygonMesh Triangulation::result(const OutlinePlane& plane) const {
  PolygonMesh result;
  const CornerNumbers numbers = corner_numbers(plane);
  const auto lifted = [&](VertexHandle vertex) {
    const auto& point = mesh_.point(vertex);
    return plane.lifted({point[0], point[1]});
  };
  for (std::size_t v = boundary_count_; v < mesh_.n_vertices(); ++v)
    result.inner.push_back(lifted(mesh_.vertex_handle(static_cast<unsigned>(v))));
  for (const VertexHandle copy : numbers.copies) result.inner.push_back(lifted(copy));
  const auto number_of = [&](HalfedgeHandle h) { return numbers.of_halfedge[static_cast<std::size_t>(h.idx())]; };
  std::vector<std::uint8_t> is_taken(mesh_.n_faces(), 0);
  result.patches.reserve(mesh_.n_faces());
  for (const EdgeHandle edge : is_line_.empty() ? std::vector<EdgeHandle>() : edges_in_quadrilaterals()) {
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const HalfedgeHandle back = mesh_.opposite_halfedge_handle(h);
    for (const HalfedgeHandle side : {h, back}) is_taken[static_cast<std::size_t>(mesh_.face_handle(side).idx())] = 1;
    const HalfedgeHandle next = mesh_.next_halfedge_handle(h);
    const HalfedgeHandle beyond = mesh_.next_halfedge_handle(back);
    result.patches.push_back({number_of(next), number_of(mesh_.next_halfedge_handle(next)), number_of(beyond),
                              number_of(mesh_.next_halfedge_handle(beyond))});
  }
  for (const auto face : mesh_.faces()) {
    if (is_flat(face) || is_taken[static_cast<std::size_t>(face.idx())] != 0) continue;
    std::array<std::uint32_t, 4> patch{};
    std::size_t k = 0;
    for (const auto h : mesh_.fh_range(face)) patch[k++] = number_of(mesh_.next_halfedge_handle(h));
    patch[3] = patch[2];
    result.patches.push_back(patch);
  }
  if (!is_line_.empty()) put_in_order(result.patches);
  return result;
}

}  // namespace

PolygonMesh delaunay_mesh(const Outline& outline, const OutlinePlane& plane, double max_edge,
                          const InnerPoints& inner) {
  Triangulation triangulation(outline, plane, max_edge);
  triangulation.cut_boundary();
  triangulation.insert_lines(inner.lines);
  triangulation.insert_rows(inner.lattice);
  triangulation.split_long_edges();
  return triangulation.result(plane);
}

}  // namespace patchlight
