#include "mesh/polygon_mesh.h"

#include "base/tolerances.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// Distance from the lattice to the boundary, in spacings. This value gives the fewest patches in the range 0.3 to 0.7.
constexpr double lattice_margin = 0.6;

OutlinePlane plane_of(const Outline& outline) {
  // Edges that are equal but for rounding count as equal: the first is taken.
  const std::size_t n = outline.corners.size();
  Vector longest = Vector::Zero();
  std::size_t first = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Vector edge = outline.corners[(k + 1) % n] - outline.corners[k];
    if (edge.norm() > (1 + tolerance_of_shapes) * longest.norm()) longest = edge, first = k;
  }
  OutlinePlane plane{.origin = outline.corners[first],
                     .axes = {},
                     .spacing = longest.norm() / outline.parts[first],
                     .is_cut = outline.parts[first] > 1};
  const Vector left = outline.normal.cross(longest).normalized();
  plane.axes << left.cross(outline.normal), left, outline.normal;
  return plane;
}

// How far the lattice's points are from each other: as those on the longest edge, but of an outline that is finer than
// the patches no nearer than that there is one to four corners. A triangulation of n points on the outline and m inside
// has n - 2 + 2 m triangles, so that these are at most half as many again as the outline takes by itself. Where that
// would leave edges that are too long the lattice is as fine as it has to be: no point of the outline is farther from
// it than (lattice_margin + 1 / sqrt(3)) spacings.
double lattice_spacing(const Outline& outline, const OutlinePlane& plane, double max_edge) {
  const double area_per_spacing = std::sqrt(0.75);
  const double spacing = plane.spacing;
  if (plane.is_cut) return spacing;
  const double area = area_vector(outline.corners).norm();
  const auto corners = static_cast<double>(outline.corners.size());
  if (area <= corners * area_per_spacing * spacing * spacing) return spacing;
  const double of_few = std::sqrt(4 * area / (corners * area_per_spacing));
  return std::max(spacing, std::min(0.8 * max_edge, of_few));  // 0.8 < 1 / (lattice_margin + 1 / sqrt(3))
}

// The points of each line, in parts that are short enough.
std::vector<std::vector<FlatPoint>> lines_in_parts(const Outline& outline, const OutlinePlane& plane, double max_edge) {
  std::vector<std::vector<FlatPoint>> lines;
  for (const auto& [from, to] : outline.lines) {
    const std::uint32_t parts = parts_of(from, to, max_edge);
    std::vector<FlatPoint>& points = lines.emplace_back();
    for (std::uint32_t k = 0; k <= parts; ++k) points.push_back(plane.flat(edge_point(from, to, k, parts)));
  }
  return lines;
}

std::vector<FlatLine> flat_lines(const Outline& outline, const OutlinePlane& plane) {
  std::vector<FlatLine> lines;
  for (const auto& [from, to] : outline.lines) lines.push_back({plane.flat(from), plane.flat(to)});
  return lines;
}

// A Delaunay mesh of triangles of any simple polygon: its triangulation with the boundary cut at the prescribed
// points, then split at the longest inner edge until none is longer than `max_edge`.
PolygonMesh refine_polygon(const Outline& outline, double max_edge) {
  const OutlinePlane plane = plane_of(outline);
  const double spacing = lattice_spacing(outline, plane, max_edge);
  std::vector<FlatPoint> corners;
  for (const Point& corner : outline.corners) corners.push_back(plane.flat(corner));

  const InnerPoints inner{lines_in_parts(outline, plane, max_edge),
                          lattice_rows(corners, flat_lines(outline, plane), spacing, lattice_margin * spacing)};
  return delaunay_mesh(outline, plane, max_edge, inner);
}

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

}  // namespace

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

std::vector<double> longest_edges(const Outline& outline, double max_edge) {
  const PolygonMesh mesh = mesh_polygon(outline, max_edge);
  std::vector<Point> points = boundary_points(outline);
  points.insert(points.end(), mesh.inner.begin(), mesh.inner.end());
  std::vector<double> edges;
  edges.reserve(mesh.patches.size());
  for (const auto& corners : mesh.patches) {
    double longest = 0;
    for (std::size_t k = 0; k < corners.size(); ++k)
      longest = std::max(longest, (points[corners[(k + 1) % corners.size()]] - points[corners[k]]).squaredNorm());
    edges.push_back(std::sqrt(longest));
  }
  return edges;
}

}  // namespace patchlight
