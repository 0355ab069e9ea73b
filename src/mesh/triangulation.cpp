#include "mesh/triangulation.h"

#include "scene/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

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

// Lines as edges of a triangulation.

namespace {

// A place as a key: ends of lines have the same bits as corners of the outline and ends of other lines.
std::array<double, 2> place_of(const FlatPoint& point) { return {point.x(), point.y()}; }

}  // namespace

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
  constexpr double rounding = 1e-9;
  const FaceHandle face = find_face(start, point);
  if (!face.is_valid()) return VertexHandle();
  for (const auto h : mesh_.fh_range(face)) {
    const auto& from = mesh_.point(mesh_.from_vertex_handle(h));
    const auto& to = mesh_.point(mesh_.to_vertex_handle(h));
    if (std::abs(turn(from, to, point)) > rounding * std::sqrt(dot(from, to, to) * max_square_)) continue;
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
std::optional<std::vector<EdgeHandle>> Triangulation::edges_across(VertexHandle from, VertexHandle to) const {
  const auto& start = mesh_.point(from);
  const auto& end = mesh_.point(to);
  const auto side = [&](VertexHandle vertex) { return turn(start, end, mesh_.point(vertex)); };

  // 1. The triangle at the first vertex through which the way begins.
  HalfedgeHandle crossed;
  for (const auto h : mesh_.voh_range(from)) {
    if (mesh_.is_boundary(h)) continue;
    const HalfedgeHandle opposite = mesh_.next_halfedge_handle(h);
    if (side(mesh_.from_vertex_handle(opposite)) < 0 && side(mesh_.to_vertex_handle(opposite)) > 0 &&
        turn(start, mesh_.point(mesh_.from_vertex_handle(opposite)), end) > 0 &&
        turn(start, end, mesh_.point(mesh_.to_vertex_handle(opposite))) > 0)
      crossed = opposite;
  }

  // 2. From triangle to triangle.
  std::vector<EdgeHandle> edges;
  while (crossed.is_valid()) {
    edges.push_back(mesh_.edge_handle(crossed));
    const HalfedgeHandle beyond = mesh_.opposite_halfedge_handle(crossed);
    if (mesh_.is_boundary(beyond) || edges.size() > mesh_.n_edges()) return std::nullopt;
    const HalfedgeHandle left = mesh_.next_halfedge_handle(beyond);
    const VertexHandle apex = mesh_.to_vertex_handle(left);
    if (apex == to) return edges;
    const double apex_side = side(apex);
    if (apex_side == 0) return std::nullopt;
    crossed = apex_side < 0 ? mesh_.next_halfedge_handle(left) : left;
  }
  return std::nullopt;
}

// Flips what is in the way until the edge is there: Sloan 1993, section 3.
bool Triangulation::make_edge(VertexHandle from, VertexHandle to) {
  if (const HalfedgeHandle there = mesh_.find_halfedge(from, to); there.is_valid()) {
    if (!mesh_.is_boundary(mesh_.edge_handle(there))) mark_as_line(mesh_.edge_handle(there));
    return true;
  }
  const auto across = edges_across(from, to);
  if (!across || std::any_of(across->begin(), across->end(), [&](EdgeHandle edge) { return is_line(edge); }))
    return false;
  const auto& start = mesh_.point(from);
  const auto& end = mesh_.point(to);
  constexpr double rounding = 1e-9;
  const auto crosses = [&](EdgeHandle edge) {
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const VertexHandle a = mesh_.from_vertex_handle(h);
    const VertexHandle b = mesh_.to_vertex_handle(h);
    if (a == from || a == to || b == from || b == to) return false;
    const double at_a = turn(start, end, mesh_.point(a));
    const double at_b = turn(start, end, mesh_.point(b));
    const double nothing = rounding * max_square_;
    return (at_a > nothing && at_b < -nothing) || (at_a < -nothing && at_b > nothing);
  };
  const auto is_convex_around = [&](EdgeHandle edge) {
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const auto& p = mesh_.point(mesh_.from_vertex_handle(h));
    const auto& q = mesh_.point(mesh_.to_vertex_handle(h));
    const auto& a = mesh_.point(mesh_.opposite_vh(h));
    const auto& b = mesh_.point(mesh_.opposite_vh(mesh_.opposite_halfedge_handle(h)));
    const double smallest = 1e-12 * dot(a, b, b);
    return turn(a, p, b) > smallest && turn(b, q, a) > smallest;
  };

  std::deque<EdgeHandle> left(across->begin(), across->end());
  std::vector<EdgeHandle> flipped;
  std::size_t tries = 10 + 2 * left.size() * left.size();
  for (; !left.empty() && tries > 0; --tries) {
    const EdgeHandle edge = left.front();
    left.pop_front();
    if (!is_convex_around(edge) || !can_flip(edge)) {
      left.push_back(edge);
      continue;
    }
    flip(edge);
    flipped.push_back(edge);
    if (crosses(edge)) left.push_back(edge);
  }
  const HalfedgeHandle made = mesh_.find_halfedge(from, to);
  if (made.is_valid()) mark_as_line(mesh_.edge_handle(made));
  for (const EdgeHandle edge : flipped) {
    remember_if_long(edge);
    suspects_.push_back(edge);
  }
  flip_suspects();
  return made.is_valid();
}

// Every part of a line that can be becomes an edge; over the others patches reach as they do without.
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
      for (const VertexHandle from : vertices[place_of(line[k])]) {
        for (const VertexHandle to : vertices[place_of(line[k + 1])]) made = made || make_edge(from, to);
      }
    }
  }
}

// The patches that a triangulation gives.

namespace {

using Corners = std::array<std::uint32_t, 4>;

// By their corners, so that their order does not tell which edges were flipped on the way.
void put_in_order(std::vector<Corners>& patches) {
  for (Corners& patch : patches) {
    const auto end = patch.begin() + (patch[2] == patch[3] ? 3 : 4);
    std::rotate(patch.begin(), std::min_element(patch.begin(), end), end);
    if (end != patch.end()) patch[3] = patch[2];
  }
  std::sort(patches.begin(), patches.end());
}

// The largest cosine of an angle at a corner, either way: 0 for a rectangle; 1 where it is above `most`.
double skewness(const std::array<Workbench::Point, 4>& corners, double most) {
  double largest = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& at = corners[k];
    const auto& before = corners[(k + 3) % 4];
    const auto& after = corners[(k + 1) % 4];
    if (turn(before, at, after) <= 0) return 1;
    largest = std::max(largest,
                       std::abs(dot(at, before, after)) / std::sqrt(dot(at, before, before) * dot(at, after, after)));
    if (largest > most) return 1;
  }
  return largest;
}

}  // namespace

// Is the triangle no more than a line but for rounding, or turned over? It then covers nothing, or what others do: at a
// corner of the polygon that lies on an edge, at the end of a line beside one or, by rounding, beyond it.
bool Triangulation::is_flat(FaceHandle face) const {
  constexpr double rounding = 1e-12;
  std::array<Workbench::Point, 3> corners;
  std::size_t k = 0;
  for (const auto vertex : mesh_.fv_range(face)) corners[k++] = mesh_.point(vertex);
  const auto& [a, b, c] = corners;
  const double squares = dot(a, b, b) + dot(b, c, c) + dot(c, a, a);
  return turn(a, b, c) <= rounding * squares + rounding_ * std::sqrt(squares);
}

// The halfedges that begin at a vertex, counter-clockwise from the boundary or, inside, from a line on.
std::vector<HalfedgeHandle> Triangulation::halfedges_around(VertexHandle vertex) const {
  std::vector<HalfedgeHandle> around;
  for (const auto h : mesh_.voh_ccw_range(vertex)) around.push_back(h);
  const auto first =
      mesh_.is_boundary(vertex)
          ? std::find_if(around.begin(), around.end(),
                         [&](auto h) { return mesh_.is_boundary(mesh_.opposite_halfedge_handle(h)); })
          : std::find_if(around.begin(), around.end(), [&](auto h) { return is_line(mesh_.edge_handle(h)); });
  if (first != around.end()) std::rotate(around.begin(), first, around.end());
  return around;
}

// Which of the two boundary edges at a vertex has the patches that keep it, the first or the last one
// counter-clockwise? A neighbour that shares both walks along them the other way, and has the same answer.
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
  constexpr double most_skew = 0.8;
  constexpr double rounding = 0x1p20;
  std::vector<std::tuple<std::int64_t, std::array<int, 2>, EdgeHandle>> candidates;
  for (const EdgeHandle edge : mesh_.edges()) {
    if (mesh_.is_boundary(edge) || is_line(edge)) continue;
    const HalfedgeHandle h = mesh_.halfedge_handle(edge, 0);
    const VertexHandle from = mesh_.from_vertex_handle(h);
    const VertexHandle to = mesh_.to_vertex_handle(h);
    const HalfedgeHandle back = mesh_.opposite_halfedge_handle(h);
    const double skew = skewness(
        {mesh_.point(from), mesh_.point(mesh_.opposite_vh(back)), mesh_.point(to), mesh_.point(mesh_.opposite_vh(h))},
        most_skew);
    if (skew <= most_skew)
      candidates.push_back(
          {std::llround(rounding * skew), {std::min(from.idx(), to.idx()), std::max(from.idx(), to.idx())}, edge});
  }
  std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
  });
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
    Corners patch{};
    std::size_t k = 0;
    for (const auto h : mesh_.fh_range(face)) patch[k++] = number_of(mesh_.next_halfedge_handle(h));
    patch[3] = patch[2];
    result.patches.push_back(patch);
  }
  if (!is_line_.empty()) put_in_order(result.patches);
  return result;
}

}  // namespace patchlight
