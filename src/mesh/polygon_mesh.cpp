#include "mesh/polygon_mesh.h"

#include "mesh/refine_polygon.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

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
