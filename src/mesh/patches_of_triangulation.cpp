// The patches that a triangulation gives.
#include "mesh/triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace patchlight {
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
