#include "mesh/mesher.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "mesh/boundary_vertices.h"
#include "mesh/cut_outlines.h"
#include "mesh/graded_edges.h"
#include "mesh/outline.h"
#include "mesh/refine_polygon.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>

namespace patchlight {
namespace {

// Patches have 32-bit indices.
constexpr double max_patches = 0x1p31;

// How a polygon is meshed.
enum class Pattern { quad_grid, triangle_grid, delaunay };

Pattern pattern_of(const Outline& outline) {
  if (!outline.lines.empty()) return Pattern::delaunay;
  const auto& parts = outline.parts;
  if (parts.size() == 3 && parts[0] == parts[1] && parts[1] == parts[2]) return Pattern::triangle_grid;
  if (is_quad_grid(outline)) return Pattern::quad_grid;
  return Pattern::delaunay;
}

// n x m quadrilaterals by bilinear interpolation of the corners.
PolygonMesh quad_grid(const Outline& outline) {
  const std::uint32_t n = outline.parts[0];
  const std::uint32_t m = outline.parts[1];
  PolygonMesh mesh;
  for (std::uint32_t j = 1; j < m; ++j) {
    for (std::uint32_t i = 1; i < n; ++i) {
      const double u = share_of_edge(i, n, grading_of_edge(outline, 0));
      const double v = share_of_edge(j, m, grading_of_edge(outline, 1));
      const auto& p = outline.corners;
      mesh.inner.push_back(p[0] + u * (p[1] - p[0]) + v * (p[3] - p[0]) + u * v * (p[0] - p[1] + p[2] - p[3]));
    }
  }
  const auto vertex = [n, m](std::uint32_t i, std::uint32_t j) {
    if (j == 0) return i;
    if (i == n) return n + j;
    if (j == m) return n + m + (n - i);
    if (i == 0) return 2 * n + m + (m - j);
    return 2 * (n + m) + (j - 1) * (n - 1) + (i - 1);
  };
  for (std::uint32_t j = 0; j < m; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.patches.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

// n^2 congruent triangles.
PolygonMesh triangle_grid(const Outline& outline) {
  const std::uint32_t n = outline.parts[0];
  PolygonMesh mesh;
  std::vector<std::uint32_t> row_begin{0, 0};  // of the inner points
  for (std::uint32_t j = 1; j < n; ++j) {
    for (std::uint32_t i = 1; i + j < n; ++i) {
      const double u = static_cast<double>(i) / n;
      const double v = static_cast<double>(j) / n;
      const auto& p = outline.corners;
      mesh.inner.push_back(p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]));
    }
    row_begin.push_back(static_cast<std::uint32_t>(mesh.inner.size()));
  }
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    if (j == 0) return i;
    if (i + j == n) return n + j;
    if (i == 0) return 2 * n + (n - j);
    return 3 * n + row_begin[j] + (i - 1);
  };
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i + j < n; ++i) {
      mesh.patches.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1), vertex(i, j + 1)});
      if (i + j + 1 == n) continue;
      mesh.patches.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

PolygonMesh mesh_polygon(const Outline& outline, double max_edge) {
  switch (pattern_of(outline)) {
    case Pattern::quad_grid:
      return quad_grid(outline);
    case Pattern::triangle_grid:
      return triangle_grid(outline);
    case Pattern::delaunay:
      break;
  }
  return refine_polygon(outline, max_edge);
}

std::size_t count_patches(const Outline& outline, double max_edge) {
  switch (pattern_of(outline)) {
    case Pattern::quad_grid:
      return std::size_t{outline.parts[0]} * outline.parts[1];
    case Pattern::triangle_grid:
      return std::size_t{outline.parts[0]} * outline.parts[0];
    case Pattern::delaunay:
      break;
  }
  return refine_polygon(outline, max_edge).patches.size();
}

std::size_t count_patches(const std::vector<CutPolygon>& polygons, const KeptSides& sides, double max_edge) {
  const std::vector<Outline> outlines = cut_outlines(polygons, max_edge);
  std::vector<std::size_t> counts(polygons.size(), 0);
  parallel_for(counts.size(), [&](std::size_t p) {
    const std::size_t kept = sides.front[p] + sides.back[p];
    if (kept > 0) counts[p] = kept * count_patches(outlines[p], max_edge);
  });
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

// The polygons' own meshes, and where each kept side goes in the whole.
struct Pieces {
  std::vector<Outline> outlines;
  std::vector<PolygonMesh> meshes;           // per polygon; empty when no side is kept
  std::vector<std::uint32_t> first_inner;    // per 2 * polygon + side: its first inner vertex
  std::array<BoundaryVertices, 2> boundary;  // per side
};

bool is_kept(const KeptSides& sides, std::size_t slot) { return (slot % 2 == 0 ? sides.front : sides.back)[slot / 2]; }

Pieces make_pieces(const Scene& scene, const KeptSides& sides, double max_edge, const ContactLines& contacts,
                   bool grade) {
  const std::size_t count = scene.polygons.size();
  Pieces pieces{.outlines = cut_outlines(cut_polygons(scene, find_loose_corners(scene), contacts, max_edge), max_edge),
                .meshes = std::vector<PolygonMesh>(count),
                .first_inner = {},
                .boundary = {}};
  if (grade) pieces.outlines = graded(std::move(pieces.outlines), sides);
  parallel_for(count, [&](std::size_t p) {
    if (sides.front[p] || sides.back[p]) pieces.meshes[p] = mesh_polygon(pieces.outlines[p], max_edge);
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
    mesh.material[patch] = material_on(scene.polygons[p], side);
    mesh.polygon[patch] = static_cast<PolygonIndex>(p);
    mesh.side[patch] = side;
    ++patch;
  }
}

double diameter(const Scene& scene) { return bounds(scene).diagonal().norm(); }

}  // namespace

PatchMesh tessellate(const Scene& scene, const KeptSides& sides, double max_edge, const ContactLines& contacts,
                     bool graded_edges) {
  assert(max_edge > 0 && sides.front.size() == scene.polygons.size() && sides.back.size() == scene.polygons.size());
  // A patch is never larger than max_edge squared.
  const double at_least = std::max(kept_area(scene, sides) / max_edge, diameter(scene)) / max_edge;
  if (at_least > max_patches) throw MemoryError("the longest patch edge is so short that it needs over 2^31 patches");

  Pieces pieces = make_pieces(scene, sides, max_edge, contacts, graded_edges);
  PatchMesh mesh;
  number_slots(mesh, pieces, sides);
  const auto& [front, back] = pieces.boundary;
  std::copy(front.points.begin(), front.points.end(), mesh.vertices.begin());
  std::copy(back.points.begin(), back.points.end(),
            mesh.vertices.begin() + static_cast<std::ptrdiff_t>(front.points.size()));
  parallel_for(2 * pieces.meshes.size(), [&](std::size_t slot) {
    if (is_kept(sides, slot)) fill_slot(mesh, scene, pieces, slot);
  });
  return mesh;
}

std::size_t least_patches(const Scene& scene, const KeptSides& sides, const ContactLines& contacts) {
  const double edge = diameter(scene);
  return count_patches(cut_polygons(scene, find_loose_corners(scene), contacts, edge), sides, edge);
}

std::vector<std::size_t> left_out_corners(const Scene& scene, double max_edge) {
  const LooseCorners loose = find_loose_corners(scene);
  std::vector<std::size_t> counts(scene.polygons.size(), 0);
  if (loose.empty()) return counts;
  parallel_for(counts.size(), [&](std::size_t p) {
    const auto polygon = static_cast<PolygonIndex>(p);
    if (loose[p].empty()) return;
    counts[p] = outline_corners(scene, polygon).size() - coarse_outline(scene, loose, polygon, max_edge).size();
  });
  return counts;
}

double max_edge_for(const Scene& scene, const KeptSides& sides, std::size_t patches, const ContactLines& contacts) {
  constexpr double close_enough = 0.005;
  constexpr double same_edge = 1 + close_enough / 2;  // as the number goes as edge^-2
  const double wanted = static_cast<double>(std::max<std::size_t>(patches, 1));
  if (wanted > max_patches) throw MemoryError("found a wish for over 2^31 patches; expected fewer");
  const LooseCorners loose = find_loose_corners(scene);
  // Edges of about one length have the same polygons but for loose corners.
  std::map<double, std::vector<CutPolygon>> known;
  const auto count = [&](double edge) {
    if (contacts.on.empty())
      return static_cast<double>(count_patches(cut_polygons(scene, loose, contacts, edge), sides, edge));
    const auto [found, is_new] = known.try_emplace(followed_detail(contacts, edge));
    found->second =
        cut_again(is_new ? std::vector<CutPolygon>() : std::move(found->second), scene, loose, contacts, edge);
    return static_cast<double>(count_patches(found->second, sides, edge));
  };

  // 1. No number below that of the uncut scene.
  double too_long = diameter(scene);
  double best = too_long;
  double best_error = wanted - count(too_long);
  if (best_error <= 0) return best;

  // 2. Keep the edge between one that gives too few patches and one that gives too many. The number goes as edge^-2;
  //    where this guess fails because the number changes in steps, halve the interval.
  double too_short = 0;
  //    The first guess is for a sixteenth of the patches: a cheap look at how many a square metre gets.
  double edge = std::min(0.5 * too_long, 4 * std::sqrt(kept_area(scene, sides) / wanted));
  for (int guesses = 1; too_long > same_edge * too_short; ++guesses) {
    const double number = count(edge);
    const double error = std::abs(number - wanted);
    if (error < best_error) best = edge, best_error = error;
    if (error <= close_enough * wanted) break;
    (number < wanted ? too_long : too_short) = edge;
    edge *= std::sqrt(number / wanted);
    const bool inside = edge > too_short && edge < too_long;
    if (!inside || guesses % 5 == 0) edge = too_short > 0 ? std::sqrt(too_short * too_long) : 0.5 * too_long;
  }
  return best;
}

}  // namespace patchlight
