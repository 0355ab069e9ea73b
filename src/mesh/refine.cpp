#include "mesh/refine.h"

#include "mesh/other_sides.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>

namespace patchlight {
namespace {

using CornerIndices = std::array<std::uint32_t, 4>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller index first

Edge edge_of(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

std::vector<Edge> edges_of(const PatchMesh& mesh, PatchIndex patch) {
  const CornerIndices& corners = mesh.corners[patch];
  const auto count = static_cast<std::size_t>(mesh.corner_points(patch).count);
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < count; ++k) edges.push_back(edge_of(corners[k], corners[(k + 1) % count]));
  return edges;
}

struct EdgeHash {
  // The golden ratio's bits spread neighbouring indices.
  std::size_t operator()(const Edge& edge) const {
    return ((std::uint64_t{edge.first} << 32 | edge.second) * 0x9e3779b97f4a7c15u) >> 16;
  }
};

// The middles of cut edges.
using Middles = std::unordered_map<Edge, std::uint32_t, EdgeHash>;

Middles middles_of(const PatchMesh& mesh) {
  Middles middles;
  middles.reserve(mesh.middles.size());
  for (const Middle& middle : mesh.middles) middles.emplace(edge_of(middle.ends[0], middle.ends[1]), middle.vertex);
  return middles;
}

// Whether one of these edges is cut and one of its halves is cut, or will be.
bool has_quarters(const std::vector<Edge>& edges, const Middles& middles, const std::set<Edge>& to_cut) {
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    const auto middle = middles.find(edge);
    if (middle == middles.end()) return false;
    const Edge halves[] = {edge_of(edge.first, middle->second), edge_of(middle->second, edge.second)};
    return std::any_of(std::begin(halves), std::end(halves),
                       [&](const Edge& half) { return middles.contains(half) || to_cut.contains(half); });
  });
}

// The marks with those that keep the sides of sheets alike.
std::vector<std::uint8_t> on_both_sides(const PatchMesh& mesh, std::span<const std::uint8_t> marked) {
  std::vector<std::uint8_t> all(marked.begin(), marked.end());
  const std::vector<PatchIndex> other_side = other_sides(mesh);
  for (PatchIndex i = 0; i < other_side.size(); ++i) {
    if (marked[i]) all[other_side[i]] = 1;
  }
  return all;
}

// The marks with those that keep neighbours one level apart.
std::vector<std::uint8_t> balanced(const PatchMesh& mesh, std::span<const std::uint8_t> marked) {
  std::vector<std::uint8_t> all = on_both_sides(mesh, marked);
  if (mesh.middles.empty()) return all;
  const std::vector<PatchIndex> other_side = other_sides(mesh);
  const Middles middles = middles_of(mesh);
  std::set<Edge> to_cut;
  const auto mark = [&](PatchIndex patch) {
    all[patch] = 1;
    for (const Edge& edge : edges_of(mesh, patch)) to_cut.insert(edge);
  };
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    if (all[i]) mark(i);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (all[i] || !has_quarters(edges_of(mesh, i), middles, to_cut)) continue;
      mark(i);
      if (!other_side.empty()) mark(other_side[i]);
      changed = true;
    }
  }
  return all;
}

// A mesh to which patches are added.
class Cutter {
 public:
  explicit Cutter(const PatchMesh& mesh) : middles_(middles_of(mesh)) {
    result_.mesh.vertices = mesh.vertices;
    result_.mesh.middles = mesh.middles;
    result_.mesh.sheets = mesh.sheets;
  }

  void add(const PatchMesh& from, PatchIndex patch, const CornerIndices& corners) {
    PatchMesh& mesh = result_.mesh;
    mesh.corners.push_back(corners);
    mesh.normal.push_back(from.normal[patch]);
    mesh.material.push_back(from.material[patch]);
    mesh.polygon.push_back(from.polygon[patch]);
    mesh.side.push_back(from.side[patch]);
    const bool is_whole = corners == from.corners[patch];
    const PatchCorners points = mesh.corner_points(static_cast<PatchIndex>(mesh.corners.size() - 1));
    mesh.centroid.push_back(is_whole ? from.centroid[patch] : area_centroid(points));
    mesh.area.push_back(is_whole ? from.area[patch] : area_vector(points).norm());
    result_.parent.push_back(patch);
  }

  std::array<CornerIndices, 4> quarters(const CornerIndices& c, bool is_triangle) {
    const std::uint32_t ab = middle(c[0], c[1]);
    const std::uint32_t bc = middle(c[1], c[2]);
    if (is_triangle) {
      const std::uint32_t ca = middle(c[2], c[0]);
      return {{{c[0], ab, ca, ca}, {ab, c[1], bc, bc}, {ca, bc, c[2], c[2]}, {ab, bc, ca, ca}}};
    }
    const std::uint32_t cd = middle(c[2], c[3]);
    const std::uint32_t da = middle(c[3], c[0]);
    // The middles of opposite edges bisect each other.
    const std::uint32_t centre = add_vertex((at(ab) + at(cd)) / 2);
    return {{{c[0], ab, centre, da}, {ab, c[1], bc, centre}, {centre, bc, c[2], cd}, {da, centre, cd, c[3]}}};
  }

  PatchIndex size() const { return result_.mesh.size(); }
  Refinement take() { return std::move(result_); }
  std::vector<PatchIndex>& first_patch() { return result_.mesh.first_patch; }

 private:
  const Point& at(std::uint32_t vertex) const { return result_.mesh.vertices[vertex]; }

  std::uint32_t add_vertex(const Point& point) {
    result_.mesh.vertices.push_back(point);
    return static_cast<std::uint32_t>(result_.mesh.vertices.size() - 1);
  }

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [place, is_new] =
        middles_.try_emplace(edge_of(a, b), static_cast<std::uint32_t>(result_.mesh.vertices.size()));
    if (is_new) {
      add_vertex((at(a) + at(b)) / 2);
      result_.mesh.middles.push_back({place->second, {a, b}});
    }
    return place->second;
  }

  Middles middles_;
  Refinement result_;
};

}  // namespace

Refinement refine(const PatchMesh& mesh, std::span<const std::uint8_t> marked) {
  assert(marked.size() == mesh.size());
  const std::vector<std::uint8_t> cut = balanced(mesh, marked);
  Cutter cutter(mesh);
  std::size_t slot = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (; slot < mesh.first_patch.size() && mesh.first_patch[slot] <= i; ++slot)
      cutter.first_patch().push_back(cutter.size());
    if (!cut[i]) {
      cutter.add(mesh, i, mesh.corners[i]);
      continue;
    }
    for (const CornerIndices& corners : cutter.quarters(mesh.corners[i], mesh.corner_points(i).count == 3))
      cutter.add(mesh, i, corners);
  }
  for (; slot < mesh.first_patch.size(); ++slot) cutter.first_patch().push_back(cutter.size());
  return cutter.take();
}

PatchMesh refine(const PatchMesh& mesh) { return refine(mesh, std::vector<std::uint8_t>(mesh.size(), 1)).mesh; }

}  // namespace patchlight
