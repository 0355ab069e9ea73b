// Lines as edges of a triangulation.
#include "mesh/triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <map>

namespace patchlight {
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

}  // namespace patchlight
