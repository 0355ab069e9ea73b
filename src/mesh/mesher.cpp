#include "mesh/mesher.h"

#include "patchlight/base/error.h"

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "base/tolerances.h"
#include "mesh/cut_polygons.h"
#include "mesh/polygon_mesh.h"
#include "scene/extent.h"
#include "scene/face_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace patchlight {

PatchCorners PatchMesh::corner_points(PatchIndex patch) const {
  const auto& indices = corners[patch];
  PatchCorners result;
  for (std::size_t k = 0; k < 4; ++k) result.points[k] = vertices[indices[k]];
  result.count = indices[3] == indices[2] ? 3 : 4;
  return result;
}

PatchRange PatchMesh::patches_on(PolygonIndex on_polygon, Side on_side) const {
  const std::size_t slot = side_slot(on_polygon, on_side);
  if (slot + 1 >= first_patch.size()) return {};
  return {first_patch[slot], first_patch[slot + 1]};
}

namespace {

// An edge of an outline, by whose ends its neighbors are found.
struct PlacedEdge {
  Point first, last;  // its ends, in the order of comes_before()
  std::uint32_t polygon;
  std::uint32_t edge;
  bool forward;  // the outline goes from the first to the last
};

bool have_same_ends(const PlacedEdge& a, const PlacedEdge& b) { return a.first == b.first && a.last == b.last; }

std::vector<PlacedEdge> placed_edges(std::span<const Outline> outlines) {
  std::vector<PlacedEdge> edges;
  for (std::uint32_t p = 0; p < outlines.size(); ++p) {
    const std::vector<Point>& corners = outlines[p].corners;
    for (std::uint32_t k = 0; k < corners.size(); ++k) {
      const Point& from = corners[k];
      const Point& to = corners[(k + 1) % corners.size()];
      const bool forward = comes_before(from, to);
      edges.push_back({forward ? from : to, forward ? to : from, p, k, forward});
    }
  }
  std::stable_sort(edges.begin(), edges.end(), [](const PlacedEdge& a, const PlacedEdge& b) {
    return a.first == b.first ? comes_before(a.last, b.last) : comes_before(a.first, b.first);
  });
  return edges;
}

// Calls back with every edge and every one of another polygon that has the same ends.
void for_each_shared(std::span<const PlacedEdge> edges, const auto& visit) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && have_same_ends(edges[begin], edges[end])) ++end;
    for (std::size_t a = begin; a < end; ++a) {
      for (std::size_t b = begin; b < end; ++b) {
        if (edges[a].polygon != edges[b].polygon) visit(edges[a], edges[b]);
      }
    }
  }
}

// From the edge after a corner into the face, perpendicular to the edge; unit.
Vector way_in(const Outline& outline, std::size_t corner) {
  const Vector along = outline.corners[(corner + 1) % outline.corners.size()] - outline.corners[corner];
  return outline.normal.cross(along).normalized();
}

// Does a kept side of the first face see one of the second beyond their edge, at less than 150 degrees?
bool sees(const PlacedEdge& a, const PlacedEdge& b, std::span<const Outline> outlines, const KeptSides& sides) {
  const Outline& one = outlines[a.polygon];
  const Outline& other = outlines[b.polygon];
  const Vector into_one = way_in(one, a.edge);
  const Vector into_other = way_in(other, b.edge);
  if (into_one.dot(into_other) < -smooth_cosine) return false;
  // At angles with a smaller sine two faces lie on each other.
  const auto is_kept = [&](std::uint32_t polygon, double height) {
    return std::abs(height) > 1e-3 && (height > 0 ? sides.front : sides.back)[polygon] != 0;
  };
  return is_kept(a.polygon, one.normal.dot(into_other)) && is_kept(b.polygon, other.normal.dot(into_one));
}

// Along an edge, from the end that comes first.
Grading grading_along(const Outline& outline, const PlacedEdge& edge) {
  const Grading grading = grading_of_edge(outline, edge.edge);
  return edge.forward ? grading : Grading{grading.at_to, grading.at_from};
}

// Grades an edge no more toward ends where the neighbor's patches do not shrink. Returns false when there are none.
bool even_out(Outline& outline, const PlacedEdge& edge, const Grading& neighbor) {
  const Grading own = grading_along(outline, edge);
  const auto clear = [&](bool at_first) {
    outline.is_graded[(edge.edge + (edge.forward == at_first ? 3 : 1)) % 4] = 0;
  };
  const bool first = own.at_from && !neighbor.at_from;
  const bool last = own.at_to && !neighbor.at_to;
  if (first) clear(true);
  if (last) clear(false);
  return first || last;
}

// The same outlines, where those that become grids of quadrilaterals know toward which of their edges patches shrink:
// edges that they share with a face they see there at less than 150 degrees (docs/theory/edges-and-contacts.md). Faces
// that go on smoothly over a common edge have the same points there: where one of them cannot shrink its patches along
// that edge, the other does not. O(n log n) for n edges, and O(n) for every face of a strip along which that goes on.
std::vector<Outline> graded(std::vector<Outline> outlines, const KeptSides& sides) {
  const std::vector<PlacedEdge> edges = placed_edges(outlines);
  for (Outline& outline : outlines) {
    if (is_quad_grid(outline)) outline.is_graded.assign(4, 0);
  }
  for_each_shared(edges, [&](const PlacedEdge& a, const PlacedEdge& b) {
    Outline& outline = outlines[a.polygon];
    if (!outline.is_graded.empty() && sees(a, b, outlines, sides)) outline.is_graded[a.edge] = 1;
  });
  for (bool changed = true; changed;) {
    changed = false;
    for_each_shared(edges, [&](const PlacedEdge& a, const PlacedEdge& b) {
      const double cosine = outlines[a.polygon].normal.dot(outlines[b.polygon].normal);
      if (std::abs(cosine) < smooth_cosine) return;
      if (even_out(outlines[a.polygon], a, grading_along(outlines[b.polygon], b))) changed = true;
    });
  }
  return outlines;
}

// The mesh's vertices on the boundaries of polygons.
struct BoundaryVertices {
  std::vector<Point> points;
  std::vector<std::vector<std::uint32_t>> of_polygon;  // index into points, per polygon and boundary point
};

constexpr std::uint32_t none = ~std::uint32_t{0};

// The corners of all outlines are numbered through; an edge has the number of the corner where it begins.
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

// The edges of all polygons, whichever of their sides are kept. A search finds the edges at a place, of one direction.
class AllEdges {
 public:
  AllEdges(const Scene& scene, std::span<const Outline> outlines, const OutlineCorners& corners)
      : outlines_(outlines),
        corners_(corners),
        near_(tolerance_of_coordinates * extent_of(scene)),
        tree_(flat_edges()) {}

  // Does a third polygon rise from the edge between two, by over a tenth of a degree, on their lit side? A slab that
  // ends at two walls, one above the other, parts the light of the stories. Its edge may be longer than theirs, or one
  // of several along them: the middle decides.
  bool wall_between(const OutlineEdge& a, const OutlineEdge& b, Side side) const {
    const double sign = side == Side::front ? 1 : -1;
    const auto [from, to] = ends_of(a.polygon, a.corner);
    const Point middle = 0.5 * (from + to);
    const FaceQuery query{
        .box = with_margin(Box(middle, middle), near_), .normal = (to - from).normalized(), .tilt = 0.01};
    bool found = false;
    tree_.for_each(query, [&](std::size_t corner) {
      const std::uint32_t polygon = polygons_[corner];
      if (found || polygon == a.polygon || polygon == b.polygon || !is_on(middle, corner)) return;
      const Vector inward = way_in(outlines_[polygon], corner - corners_.first[polygon]);
      const auto rises = [&](std::uint32_t face) { return sign * inward.dot(outlines_[face].normal) > 2e-3; };
      found = rises(a.polygon) && rises(b.polygon);
    });
    return found;
  }

 private:
  std::array<Point, 2> ends_of(std::uint32_t polygon, std::size_t corner) const {
    const std::vector<Point>& of_polygon = outlines_[polygon].corners;
    const std::size_t k = corner - corners_.first[polygon];
    return {of_polygon[k], of_polygon[(k + 1) % of_polygon.size()]};
  }

  // As faces without area, whose normals are the directions of the edges.
  std::vector<FlatFace> flat_edges() {
    std::vector<FlatFace> edges;
    for (std::uint32_t p = 0; p < outlines_.size(); ++p) {
      for (std::uint32_t c = corners_.first[p]; c < corners_.first[p + 1]; ++c) {
        const auto [from, to] = ends_of(p, c);
        edges.push_back(
            {.box = Box(from, from).extend(to), .normal = (to - from).normalized(), .mean = from, .farthest = to});
        polygons_.push_back(p);
      }
    }
    return edges;
  }

  // Is a point on the edge after this corner?
  bool is_on(const Point& point, std::size_t corner) const {
    const auto [from, to] = ends_of(polygons_[corner], corner);
    const Vector along = to - from;
    const double t = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (point - from - t * along).norm() <= near_;
  }

  std::span<const Outline> outlines_;
  const OutlineCorners& corners_;
  std::vector<std::uint32_t> polygons_;  // per corner
  double near_;                          // meters
  FaceTree tree_;
};

// Per edge the edge of the smooth neighbor, or none.
std::vector<std::uint32_t> smooth_neighbors(std::span<const Outline> outlines, std::span<const OutlineEdge> edges,
                                            std::size_t corner_count, const AllEdges& all, Side side) {
  std::vector<std::uint32_t> neighbor(corner_count, none);
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].place() == edges[begin].place()) ++end;
    if (end - begin != 2) continue;
    const OutlineEdge& a = edges[begin];
    const OutlineEdge& b = edges[begin + 1];
    if (a.forward == b.forward) continue;
    if (outlines[a.polygon].normal.dot(outlines[b.polygon].normal) <= smooth_cosine) continue;
    if (all.wall_between(a, b, side)) continue;
    neighbor[a.corner] = b.corner;
    neighbor[b.corner] = a.corner;
  }
  return neighbor;
}

// Per corner the first of the corners it is united with.
std::vector<std::uint32_t> unite(const OutlineCorners& corners, std::span<const std::uint32_t> neighbor) {
  std::vector<std::uint32_t> next(neighbor.size());
  for (std::uint32_t p = 0; p + 1 < corners.first.size(); ++p) {
    for (std::uint32_t c = corners.first[p]; c < corners.first[p + 1]; ++c) next[c] = corners.next(p, c);
  }
  DisjointSets sets(neighbor.size());
  for (std::uint32_t c = 0; c < neighbor.size(); ++c) {
    if (neighbor[c] == none) continue;
    sets.join(c, next[neighbor[c]]);
    sets.join(next[c], neighbor[c]);
  }
  std::vector<std::uint32_t> first(neighbor.size());
  for (std::uint32_t c = 0; c < first.size(); ++c) first[c] = sets.root(c);
  return first;
}

// Numbers the boundary points of this side of the kept polygons (kept[p] != 0). Two polygons share the points of a
// common edge if all of these hold:
// - they have the same material and traverse the edge in opposite directions;
// - no other polygon of that material has the edge;
// - their normals differ by less than 30 degrees;
// - no third polygon with an edge through its middle rises from it on this side.
// They share the corners too. All other points are separate. Positions are compared bit by bit.
BoundaryVertices number_boundary(const Scene& scene, std::span<const Outline> outlines, Side side,
                                 std::span<const std::uint8_t> kept) {
  BoundaryVertices result{.points = {}, .of_polygon = std::vector<std::vector<std::uint32_t>>(outlines.size())};
  if (std::none_of(kept.begin(), kept.end(), [](std::uint8_t one) { return one != 0; })) return result;

  // 1. Which edges and corners are shared.
  const OutlineCorners corners = count_corners(outlines);
  const std::vector<std::uint32_t> place = weld(outlines);
  const std::vector<OutlineEdge> edges = sorted_edges(scene, corners, side, kept, place);
  const std::vector<std::uint32_t> neighbor =
      smooth_neighbors(outlines, edges, place.size(), AllEdges(scene, outlines, corners), side);
  const std::vector<std::uint32_t> shared = unite(corners, neighbor);

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
      const bool made = neighbor[c] != none && edge_vertex[neighbor[c]] != none;
      edge_vertex[c] = made ? edge_vertex[neighbor[c]] : size();
      for (std::uint32_t i = 1; i < parts; ++i, ++next_point) {
        if (!made) result.points.push_back(points[next_point]);
        result.of_polygon[p].push_back(edge_vertex[c] + (made ? parts - 1 - i : i - 1));
      }
    }
  }
  return result;
}

// The polygons' own meshes, and where each kept side goes in the whole.
struct MeshedPieces {
  std::vector<Outline> outlines;
  std::vector<PolygonMesh> meshes;           // per polygon; empty when no side is kept
  std::vector<std::uint32_t> first_inner;    // per 2 * polygon + side: its first inner vertex
  std::array<BoundaryVertices, 2> boundary;  // per side
};

bool is_kept(const KeptSides& sides, std::size_t slot) { return (slot % 2 == 0 ? sides.front : sides.back)[slot / 2]; }

MeshedPieces make_pieces(const Scene& scene, const KeptSides& sides, const PatchEdges& edges,
                         const ContactLines& contacts, bool grade) {
  const std::size_t count = scene.polygons.size();
  MeshedPieces pieces{.outlines = cut_outlines(cut_polygons(scene, find_loose_corners(scene), contacts, edges), edges),
                      .meshes = std::vector<PolygonMesh>(count),
                      .first_inner = {},
                      .boundary = {}};
  if (grade) pieces.outlines = graded(std::move(pieces.outlines), sides);
  parallel_for(count, [&](std::size_t p) {
    if (sides.front[p] || sides.back[p]) pieces.meshes[p] = mesh_polygon(pieces.outlines[p], edges.on(p));
  });
  pieces.boundary = {number_boundary(scene, pieces.outlines, Side::front, sides.front),
                     number_boundary(scene, pieces.outlines, Side::back, sides.back)};
  return pieces;
}

// Vertices: the boundaries' of the front sides, those of the back sides, then the inner ones slot by slot.
void number_slots(PatchMesh& mesh, MeshedPieces& pieces, const KeptSides& sides) {
  std::size_t vertices = pieces.boundary[0].points.size() + pieces.boundary[1].points.size();
  std::size_t patches = 0;
  for (std::size_t slot = 0; slot < 2 * pieces.meshes.size(); ++slot) {
    mesh.first_patch.push_back(static_cast<PatchIndex>(patches));
    pieces.first_inner.push_back(static_cast<std::uint32_t>(vertices));
    if (!is_kept(sides, slot)) continue;
    patches += pieces.meshes[slot / 2].patches.size();
    vertices += pieces.meshes[slot / 2].inner.size();
  }
  mesh.first_patch.push_back(static_cast<PatchIndex>(patches));
  mesh.vertices.resize(vertices);
  mesh.corners.resize(patches);
  mesh.centroid.resize(patches);
  mesh.normal.resize(patches);
  mesh.area.resize(patches);
  mesh.material.resize(patches);
  mesh.polygon.resize(patches);
  mesh.side.resize(patches);
}

// The corners of a patch as seen from the other side.
std::array<std::uint32_t, 4> reversed(const std::array<std::uint32_t, 4>& corners) {
  const auto& [a, b, c, d] = corners;
  return c == d ? std::array{c, b, a, a} : std::array{d, c, b, a};
}

// Writes the inner vertices and the patches of one kept side of a polygon.
void fill_slot(PatchMesh& mesh, const Scene& scene, const MeshedPieces& pieces, std::size_t slot) {
  const std::size_t p = slot / 2;
  const bool back = slot % 2 == 1;
  const Side side = back ? Side::back : Side::front;
  const PolygonMesh& piece = pieces.meshes[p];
  const Vector normal = back ? Vector(-pieces.outlines[p].normal) : pieces.outlines[p].normal;
  const std::vector<std::uint32_t>& boundary = pieces.boundary[back ? 1 : 0].of_polygon[p];
  const std::size_t boundary_begin = back ? pieces.boundary[0].points.size() : 0;
  const auto global = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(vertex < boundary.size() ? boundary_begin + boundary[vertex]
                                                               : pieces.first_inner[slot] + vertex - boundary.size());
  };

  std::copy(piece.inner.begin(), piece.inner.end(), mesh.vertices.begin() + pieces.first_inner[slot]);
  PatchIndex patch = mesh.first_patch[slot];
  for (const auto& corners : piece.patches) {
    auto& indices = mesh.corners[patch] = back ? reversed(corners) : corners;
    for (std::uint32_t& index : indices) index = global(index);
    const PatchCorners points = mesh.corner_points(patch);
    mesh.centroid[patch] = area_centroid(points);
    mesh.normal[patch] = normal;
    mesh.area[patch] = normal.dot(area_vector(points));
    assert(mesh.area[patch] > 0);
    mesh.material[patch] = material_on(scene.polygons[p], side);
    mesh.polygon[patch] = static_cast<PolygonIndex>(p);
    mesh.side[patch] = side;
    ++patch;
  }
}

}  // namespace

void require_so_many_patches(const Scene& scene, const KeptSides& sides, const PatchEdges& edges) {
  // On average, patches of a polygon are no larger than the square of its longest edge.
  double at_least = bounds(scene).diagonal().norm() / edges.max_edge;
  double sum = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const int kept = sides.front[p] + sides.back[p];
    if (kept > 0) sum += kept * area_vector(corner_points(scene, p)).norm() / (edges.on(p) * edges.on(p));
  }
  at_least = edges.coarsest.empty() ? std::max(at_least, sum) : sum;
  if (at_least > max_patches) throw MemoryError("the longest patch edge is so short that it needs over 2^31 patches");
}

PatchMesh tessellate(const Scene& scene, const KeptSides& sides, const PatchEdges& edges, const ContactLines& contacts,
                     bool graded_edges) {
  assert(edges.max_edge > 0 && sides.front.size() == scene.polygons.size() &&
         sides.back.size() == scene.polygons.size());
  require_so_many_patches(scene, sides, edges);
  MeshedPieces pieces = make_pieces(scene, sides, edges, contacts, graded_edges);
  PatchMesh mesh;
  number_slots(mesh, pieces, sides);
  const auto& [front, back] = pieces.boundary;
  std::copy(front.points.begin(), front.points.end(), mesh.vertices.begin());
  std::copy(back.points.begin(), back.points.end(),
            mesh.vertices.begin() + static_cast<std::ptrdiff_t>(front.points.size()));
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (sides.front[p] && sides.back[p] && is_sheet(scene, p)) mesh.sheets.push_back(p);
  }
  parallel_for(2 * pieces.meshes.size(), [&](std::size_t slot) {
    if (is_kept(sides, slot)) fill_slot(mesh, scene, pieces, slot);
  });
  return mesh;
}

}  // namespace patchlight
