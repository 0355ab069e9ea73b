#include "mesh/triangulation.h"

#include "scene/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {

Triangulation::Triangulation(const Outline& outline, const OutlinePlane& plane, double max_edge)
    : max_square_(max_edge * max_edge) {
  const std::vector<Point> boundary = boundary_points(outline);
  boundary_count_ = boundary.size();
  for (const Point& corner : outline.corners) {
    constexpr double roundings = 8;  // of the coordinates and of the plane's axes
    const double of_corner = roundings * std::numeric_limits<double>::epsilon() * corner.cwiseAbs().maxCoeff();
    rounding_ = std::max(rounding_, of_corner);
  }
  for (const Point& point : boundary) {
    const FlatPoint flat = plane.flat(point);
    mesh_.add_vertex({flat.x(), flat.y(), 0});
  }
  std::vector<VertexHandle> corners;
  std::uint32_t next = 0;
  for (const std::uint32_t parts : outline.parts) corners.push_back(mesh_.vertex_handle(next)), next += parts;
  for (const auto& [a, b, c] : triangulate(outline.corners)) mesh_.add_face(corners[a], corners[b], corners[c]);
}

double Triangulation::squared_length(EdgeHandle edge) const {
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  const auto& from = mesh_.point(mesh_.from_vertex_handle(h));
  const auto& to = mesh_.point(mesh_.to_vertex_handle(h));
  return dot(from, to, to);
}

// 2^20 log2 of the squared length in units of max_edge: lengths that differ by rounding only come out equal, so that a
// turned polygon is split in the same order.
std::int64_t Triangulation::rounded_length(EdgeHandle edge) const {
  return std::llround(0x1p20 * std::log2(squared_length(edge) / max_square_));
}

// An edge of max_edge but for rounding is not too long.
void Triangulation::remember_if_long(EdgeHandle edge) {
  constexpr double rounding = 1e-9;
  if (mesh_.is_boundary(edge) || squared_length(edge) <= (1 + rounding) * max_square_) return;
  long_edges_.push({rounded_length(edge), edge});
}

// Is the sum of the angles opposite to the edge above 180 degrees, and do the edge's two triangles form a strictly
// convex quadrilateral? The tolerances keep rounding from flipping an edge to and fro.
bool Triangulation::must_flip(EdgeHandle edge) const {
  // Corners of narrow strips beside lines know their angles less well.
  const double angle_tolerance = is_line_.empty() ? 1e-9 : 1e-6;
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

// Are the two vertices opposite to the edge not joined yet? Around both at once, as one may have very many neighbours.
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

// As OpenMesh does it, which asks around one vertex first and may have to go around very many.
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

void Triangulation::make_delaunay() {
  for (const EdgeHandle edge : mesh_.edges()) suspects_.push_back(edge);
  flip_suspects();
}

void Triangulation::split(EdgeHandle edge, VertexHandle at) {
  const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
  const std::array<VertexHandle, 2> ends{mesh_.from_vertex_handle(h), mesh_.to_vertex_handle(h)};
  const bool of_line = is_line(edge);
  mesh_.split(edge, at);
  for (const VertexHandle end : ends) {
    if (of_line) mark_as_line(mesh_.edge_handle(mesh_.find_halfedge(at, end)));
  }
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

// A point on the edge but for rounding counts as left of it.
bool Triangulation::is_left_of(HalfedgeHandle edge, const Workbench::Point& point) const {
  constexpr double rounding = 1e-9;
  const auto& from = mesh_.point(mesh_.from_vertex_handle(edge));
  const auto& to = mesh_.point(mesh_.to_vertex_handle(edge));
  return turn(from, to, point) >= -rounding * std::sqrt(dot(from, to, to) * max_square_);
}

// Walks from triangle to triangle towards the point. Where the boundary of a concave polygon is in the way, every
// triangle is tried.
FaceHandle Triangulation::find_face(FaceHandle start, const Workbench::Point& point) const {
  const auto exit_of = [&](FaceHandle face) {
    for (const auto edge : mesh_.fh_range(face)) {
      if (!is_left_of(edge, point)) return HalfedgeHandle(edge);
    }
    return HalfedgeHandle();
  };
  FaceHandle face = start;
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
    const auto [length, edge] = long_edges_.top();
    long_edges_.pop();
    // An edge that was split or flipped since has another length and its own entry.
    if (rounded_length(edge) != length) continue;
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const auto middle = 0.5 * (mesh_.point(mesh_.from_vertex_handle(h)) + mesh_.point(mesh_.to_vertex_handle(h)));
    split(edge, mesh_.add_vertex(middle));
  }
}

}  // namespace patchlight
