#include "scene/pieces.h"

#include "scene/simple_polygon.h"

#include <array>
#include <cstdint>

namespace patchlight {
namespace {

// The polygon with other corners.
Polygon with_corners(Polygon polygon, std::vector<std::uint32_t> corners) {
  polygon.corners = std::move(corners);
  return polygon;
}

// Those triangles of a polygon that are not narrow.
std::vector<Polygon> in_triangles(const Polygon& polygon, const std::vector<Point>& points,
                                  const std::vector<std::array<std::uint32_t, 3>>& triangles, double width) {
  std::vector<Polygon> pieces;
  for (const auto& [a, b, c] : triangles) {
    if (is_narrow(std::array{points[a], points[b], points[c]}, width)) continue;
    pieces.push_back(with_corners(polygon, {polygon.corners[a], polygon.corners[b], polygon.corners[c]}));
  }
  return pieces;
}

// The two triangles of a bent quadrilateral: of both diagonals the one over which it is bent less.
std::vector<std::array<std::uint32_t, 3>> folded(const std::vector<Point>& points) {
  const auto cosine = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t d) {  // over the diagonal a c
    const Vector one = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
    return one.dot((points[c] - points[a]).cross(points[d] - points[a]).normalized());
  };
  if (cosine(0, 1, 2, 3) >= cosine(1, 2, 3, 0)) return {{0, 1, 2}, {0, 2, 3}};
  return {{1, 2, 3}, {1, 3, 0}};
}

// A polygon that does not cross itself: whole when it is planar, else in triangles.
Pieces simple_pieces(const Polygon& polygon, const std::vector<Point>& points, double width) {
  if (polygon.corners.size() == 3) return {{polygon}, {}, {}};
  const bool planar = is_planar(points);
  if (!planar && points.size() == 4)
    return {in_triangles(polygon, points, folded(points), width), {}, DiagnosticCode::non_planar};
  const auto triangles = proper_triangles(points);
  if (!triangles) return {{}, {}, DiagnosticCode::self_intersecting};
  if (planar) return {{polygon}, {}, {}};
  return {in_triangles(polygon, points, *triangles, width), {}, DiagnosticCode::non_planar};
}

// A polygon that crosses itself, cut at the crossings.
Pieces cut_pieces(const Scene& scene, const Polygon& polygon, const std::vector<Point>& points, double width) {
  Pieces cut{{}, {}, DiagnosticCode::self_intersecting};
  for (const std::vector<Point>& loop : cut_at_crossings(points, width)) {
    std::vector<std::uint32_t> corners;
    for (const Point& point : loop) {
      corners.push_back(static_cast<std::uint32_t>(scene.vertices.size() + cut.new_vertices.size()));
      cut.new_vertices.push_back(point);
    }
    Polygon piece = with_corners(polygon, corners);
    for (Polygon& simple : simple_pieces(piece, loop, width).polygons) cut.polygons.push_back(std::move(simple));
  }
  return cut;
}

}  // namespace

Pieces pieces_of(const Scene& scene, const Polygon& polygon, double width) {
  std::vector<Point> points;
  for (const std::uint32_t corner : polygon.corners) points.push_back(scene.vertices[corner]);
  if (points.size() < 3 || is_narrow(points, width)) return {{}, {}, DiagnosticCode::zero_area};
  const bool is_bent_quadrilateral = points.size() == 4 && !is_planar(points);
  if (!is_bent_quadrilateral && crosses_itself(points)) return cut_pieces(scene, polygon, points, width);
  return simple_pieces(polygon, points, width);
}

}  // namespace patchlight
