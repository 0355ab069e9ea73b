#include "mesh/mesher.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/boundary_vertices.h"
#include "mesh/cut_outlines.h"
#include "mesh/cut_polygons.h"
#include "mesh/graded_edges.h"
#include "mesh/outline.h"
#include "mesh/polygon_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace patchlight {
namespace {

// The polygons' own meshes, and where each kept side goes in the whole.
struct Pieces {
  std::vector<Outline> outlines;
  std::vector<PolygonMesh> meshes;           // per polygon; empty when no side is kept
  std::vector<std::uint32_t> first_inner;    // per 2 * polygon + side: its first inner vertex
  std::array<BoundaryVertices, 2> boundary;  // per side
};

bool is_kept(const KeptSides& sides, std::size_t slot) { return (slot % 2 == 0 ? sides.front : sides.back)[slot / 2]; }

Pieces make_pieces(const Scene& scene, const KeptSides& sides, const PatchEdges& edges, const ContactLines& contacts,
                   bool grade) {
  const std::size_t count = scene.polygons.size();
  Pieces pieces{.outlines = cut_outlines(cut_polygons(scene, find_loose_corners(scene), contacts, edges), edges),
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
void number_slots(PatchMesh& mesh, Pieces& pieces, const KeptSides& sides) {
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
void fill_slot(PatchMesh& mesh, const Scene& scene, const Pieces& pieces, std::size_t slot) {
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
  // Patches of a polygon are in the mean no larger than the square of its longest edge.
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
  Pieces pieces = make_pieces(scene, sides, edges, contacts, graded_edges);
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
