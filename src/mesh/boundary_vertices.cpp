#include "mesh/boundary_vertices.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace patchlight {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};

// A surface that leaves another by less than this sine, a tenth of a degree, lies in it.
constexpr double flat_sine = 2e-3;

// OutlineCorners of all outlines are numbered through; an edge has the number of the corner where it begins.
struct OutlineCorners {
  std::vector<std::uint32_t> first;  // per polygon, one more at the end

  std::uint32_t next(std::uint32_t polygon, std::uint32_t corner) const {
    return corner + 1 == first[polygon + 1] ? first[polygon] : corner + 1;
  }
};

struct OutlineEdge {
  std::uint32_t low, high;  // places of its ends
  MaterialIndex material;
  std::uint32_t polygon, corner;
  bool forward;  // traversed from low to high

  auto place() const { return std::tuple(low, high, material); }
};

OutlineCorners count_corners(std::span<const Outline> outlines) {
  OutlineCorners corners{.first = {0}};
  for (const Outline& outline : outlines) {
    corners.first.push_back(corners.first.back() + static_cast<std::uint32_t>(outline.corners.size()));
  }
  return corners;
}

// A number per corner, equal for corners at the same position.
std::vector<std::uint32_t> weld(std::span<const Outline> outlines) {
  std::vector<Point> points;
  for (const Outline& outline : outlines) points.insert(points.end(), outline.corners.begin(), outline.corners.end());
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return comes_before(points[a], points[b]); });
  std::vector<std::uint32_t> place(points.size());
  for (std::size_t k = 1; k < order.size(); ++k) {
    place[order[k]] = place[order[k - 1]] + (points[order[k]] != points[order[k - 1]] ? 1 : 0);
  }
  return place;
}

std::vector<OutlineEdge> sorted_edges(const Scene& scene, const OutlineCorners& corners, Side side,
                                      std::span<const std::uint8_t> kept, std::span<const std::uint32_t> place) {
  std::vector<OutlineEdge> edges;
  for (std::uint32_t p = 0; p < kept.size(); ++p) {
    if (!kept[p]) continue;
    const MaterialIndex material = material_on(scene.polygons[p], side);
    for (std::uint32_t c = corners.first[p]; c < corners.first[p + 1]; ++c) {
      const std::uint32_t from = place[c];
      const std::uint32_t to = place[corners.next(p, c)];
      edges.push_back({std::min(from, to), std::max(from, to), material, p, c, from < to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const OutlineEdge& a, const OutlineEdge& b) {
    return std::tuple(a.place(), a.corner) < std::tuple(b.place(), b.corner);
  });
  return edges;
}

// The edges of all polygons, whichever of their sides are kept.
class AllEdges {
 public:
  AllEdges(std::span<const Outline> outlines, const OutlineCorners& corners, std::span<const std::uint32_t> place)
      : outlines_(outlines), corners_(corners) {
    for (std::uint32_t p = 0; p < outlines.size(); ++p) {
      for (std::uint32_t c = corners.first[p]; c < corners.first[p + 1]; ++c) {
        const auto [low, high] = std::minmax({place[c], place[corners.next(p, c)]});
        edges_.push_back({low, high, p, c});
      }
    }
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
      return std::tuple(a.low, a.high, a.corner) < std::tuple(b.low, b.high, b.corner);
    });
  }

  // Does a third polygon stand on the edge between two, on the side of them that is lit? A slab that ends at two walls,
  // one above the other, parts the light of the storeys.
  bool wall_between(const OutlineEdge& a, const OutlineEdge& b, Side side) const {
    const double sign = side == Side::front ? 1 : -1;
    const auto range = std::equal_range(edges_.begin(), edges_.end(), Edge{a.low, a.high, 0, 0}, before);
    return std::any_of(range.first, range.second, [&](const Edge& edge) {
      if (edge.polygon == a.polygon || edge.polygon == b.polygon) return false;
      const Vector inward = inward_from(edge);
      return sign * inward.dot(outlines_[a.polygon].normal) > flat_sine &&
             sign * inward.dot(outlines_[b.polygon].normal) > flat_sine;
    });
  }

 private:
  struct Edge {
    std::uint32_t low, high, polygon, corner;
  };
  static bool before(const Edge& a, const Edge& b) { return std::tuple(a.low, a.high) < std::tuple(b.low, b.high); }

  // From an edge into its polygon, along its plane.
  Vector inward_from(const Edge& edge) const {
    const Outline& outline = outlines_[edge.polygon];
    const std::uint32_t first = corners_.first[edge.polygon];
    const Vector along =
        outline.corners[corners_.next(edge.polygon, edge.corner) - first] - outline.corners[edge.corner - first];
    return outline.normal.cross(along).normalized();
  }

  std::span<const Outline> outlines_;
  const OutlineCorners& corners_;
  std::vector<Edge> edges_;
};

// Per edge the edge of the smooth neighbour, or none.
std::vector<std::uint32_t> smooth_neighbours(std::span<const Outline> outlines, std::span<const OutlineEdge> edges,
                                             std::size_t corner_count, const AllEdges& all, Side side) {
  std::vector<std::uint32_t> neighbour(corner_count, none);
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].place() == edges[begin].place()) ++end;
    if (end - begin != 2) continue;
    const OutlineEdge& a = edges[begin];
    const OutlineEdge& b = edges[begin + 1];
    if (a.forward == b.forward) continue;
    if (outlines[a.polygon].normal.dot(outlines[b.polygon].normal) <= smooth_cosine) continue;
    if (all.wall_between(a, b, side)) continue;
    neighbour[a.corner] = b.corner;
    neighbour[b.corner] = a.corner;
  }
  return neighbour;
}

std::uint32_t root(std::vector<std::uint32_t>& parent, std::uint32_t corner) {
  while (parent[corner] != corner) corner = parent[corner] = parent[parent[corner]];
  return corner;
}

// Per corner the first of the corners it is united with.
std::vector<std::uint32_t> unite(const OutlineCorners& corners, std::span<const std::uint32_t> neighbour) {
  std::vector<std::uint32_t> next(neighbour.size());
  for (std::uint32_t p = 0; p + 1 < corners.first.size(); ++p) {
    for (std::uint32_t c = corners.first[p]; c < corners.first[p + 1]; ++c) next[c] = corners.next(p, c);
  }
  std::vector<std::uint32_t> parent(neighbour.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({root(parent, a), root(parent, b)});
    parent[high] = low;
  };
  for (std::uint32_t c = 0; c < neighbour.size(); ++c) {
    if (neighbour[c] == none) continue;
    join(c, next[neighbour[c]]);
    join(next[c], neighbour[c]);
  }
  for (std::uint32_t c = 0; c < parent.size(); ++c) parent[c] = root(parent, c);
  return parent;
}

}  // namespace

BoundaryVertices number_boundary(const Scene& scene, std::span<const Outline> outlines, Side side,
                                 std::span<const std::uint8_t> kept) {
  BoundaryVertices result{.points = {}, .of_polygon = std::vector<std::vector<std::uint32_t>>(outlines.size())};
  if (std::none_of(kept.begin(), kept.end(), [](std::uint8_t one) { return one != 0; })) return result;

  // 1. Which edges and corners are shared.
  const OutlineCorners corners = count_corners(outlines);
  const std::vector<std::uint32_t> place = weld(outlines);
  const std::vector<OutlineEdge> edges = sorted_edges(scene, corners, side, kept, place);
  const std::vector<std::uint32_t> neighbour =
      smooth_neighbours(outlines, edges, place.size(), AllEdges(outlines, corners, place), side);
  const std::vector<std::uint32_t> shared = unite(corners, neighbour);

  // 2. The first polygon at a corner or an edge makes the vertices; the others use them, on an edge in reverse order.
  std::vector<std::uint32_t> corner_vertex(place.size(), none);
  std::vector<std::uint32_t> edge_vertex(place.size(), none);
  const auto size = [&] { return static_cast<std::uint32_t>(result.points.size()); };
  for (std::uint32_t p = 0; p < outlines.size(); ++p) {
    if (!kept[p]) continue;
    const Outline& outline = outlines[p];
    const std::vector<Point> points = boundary_points(outline);
    std::size_t next_point = 0;
    for (std::uint32_t c = corners.first[p]; c < corners.first[p + 1]; ++c) {
      std::uint32_t& vertex = corner_vertex[shared[c]];
      if (vertex == none) vertex = size(), result.points.push_back(points[next_point]);
      ++next_point;
      result.of_polygon[p].push_back(vertex);
      const std::uint32_t parts = outline.parts[c - corners.first[p]];
      const bool made = neighbour[c] != none && edge_vertex[neighbour[c]] != none;
      edge_vertex[c] = made ? edge_vertex[neighbour[c]] : size();
      for (std::uint32_t i = 1; i < parts; ++i, ++next_point) {
        if (!made) result.points.push_back(points[next_point]);
        result.of_polygon[p].push_back(edge_vertex[c] + (made ? parts - 1 - i : i - 1));
      }
    }
  }
  return result;
}

}  // namespace patchlight
