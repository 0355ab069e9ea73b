#include "mesh/refine_polygon.h"

#include "mesh/lattice.h"
#include "mesh/triangulation.h"

#include <cmath>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Of the lattice to the boundary, in spacings: of .3 to .7, the one with the fewest patches.
constexpr double lattice_margin = 0.6;

OutlinePlane plane_of(const Outline& outline) {
  // Edges that are equal but for rounding count as equal: the first is taken.
  constexpr double rounding = 1e-9;
  const std::size_t n = outline.corners.size();
  Vector longest = Vector::Zero();
  std::size_t first = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Vector edge = outline.corners[(k + 1) % n] - outline.corners[k];
    if (edge.norm() > (1 + rounding) * longest.norm()) longest = edge, first = k;
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
  constexpr double corners_per_point = 4;
  constexpr double reaches_outline = 0.8;  // < 1 / (lattice_margin + 1 / sqrt(3))
  const double area_per_spacing = std::sqrt(0.75);
  const double spacing = plane.spacing;
  if (plane.is_cut) return spacing;
  const double area = area_vector(outline.corners).norm();
  const auto corners = static_cast<double>(outline.corners.size());
  if (area <= corners * area_per_spacing * spacing * spacing) return spacing;
  const double of_few = std::sqrt(corners_per_point * area / (corners * area_per_spacing));
  return std::max(spacing, std::min(reaches_outline * max_edge, of_few));
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

}  // namespace

PolygonMesh refine_polygon(const Outline& outline, double max_edge) {
  const OutlinePlane plane = plane_of(outline);
  const double spacing = lattice_spacing(outline, plane, max_edge);
  std::vector<FlatPoint> corners;
  for (const Point& corner : outline.corners) corners.push_back(plane.flat(corner));

  Triangulation triangulation(outline, plane, max_edge);
  triangulation.make_delaunay();
  triangulation.cut_boundary();
  triangulation.insert_lines(lines_in_parts(outline, plane, max_edge));
  triangulation.insert_rows(lattice_rows(corners, flat_lines(outline, plane), spacing, lattice_margin * spacing));
  triangulation.split_long_edges();
  return triangulation.result(plane);
}

}  // namespace patchlight
