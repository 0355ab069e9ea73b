#include "scene/openings.h"

#include "scene/coverings.h"
#include "scene/extent.h"
#include "scene/model_face.h"
#include "scene/pieces.h"
#include "scene/simple_polygon.h"
#include "scene/triangulate.h"
#include "scene/turn.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

using Loop = std::vector<std::uint32_t>;

std::vector<Point> points_of(const Scene& scene, const Loop& loop) {
  std::vector<Point> points;
  for (const std::uint32_t corner : loop) points.push_back(scene.vertices[corner]);
  return points;
}

double distance(const Point& point, const Point& from, const Point& to) {
  const Vector edge = to - from;
  const double along = std::clamp(edge.dot(point - from) / edge.squaredNorm(), 0.0, 1.0);
  return (point - from - along * edge).norm();
}

// True when two segments of one plane cross or come nearer than `near`.
bool meet(const std::pair<Point, Point>& a, const std::pair<Point, Point>& b, const Vector& normal, double near) {
  const bool cross = turn(normal, a.first, a.second, b.first) * turn(normal, a.first, a.second, b.second) < 0 &&
                     turn(normal, b.first, b.second, a.first) * turn(normal, b.first, b.second, a.second) < 0;
  return cross || distance(a.first, b.first, b.second) <= near || distance(a.second, b.first, b.second) <= near ||
         distance(b.first, a.first, a.second) <= near || distance(b.second, a.first, a.second) <= near;
}

std::pair<Point, Point> edge_of(const Scene& scene, const Loop& loop, std::size_t k) {
  return {scene.vertices[loop[k]], scene.vertices[loop[(k + 1) % loop.size()]]};
}

bool outlines_meet(const Scene& scene, const Loop& a, const Loop& b, const Vector& normal, double near) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t n = 0; n < b.size(); ++n) {
      if (meet(edge_of(scene, a, k), edge_of(scene, b, n), normal, near)) return true;
    }
  }
  return false;
}

bool contains(const std::vector<Point>& outline, const Point& point) {
  const auto triangles = triangulate(outline);
  const Vector normal = area_vector(outline);
  return std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) {
    return turn(normal, outline[t[0]], outline[t[1]], point) >= 0 &&
           turn(normal, outline[t[1]], outline[t[2]], point) >= 0 &&
           turn(normal, outline[t[2]], outline[t[0]], point) >= 0;
  });
}

// Is a segment between corners of two loops free of the edges of a loop, but for those at its own ends?
bool is_free(const Scene& scene, std::uint32_t from, std::uint32_t to, const Loop& loop, const Vector& normal) {
  const std::pair<Point, Point> segment{scene.vertices[from], scene.vertices[to]};
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::uint32_t a = loop[k];
    const std::uint32_t b = loop[(k + 1) % loop.size()];
    if (a == from || a == to || b == from || b == to) continue;
    if (meet(segment, edge_of(scene, loop, k), normal, 0)) return false;
  }
  return true;
}

// The outline joined to a hole by the shortest seam that crosses no edge; `holes` are all that are to be joined.
std::optional<Loop> joined(const Scene& scene, const Loop& outline, std::span<const Loop> holes, const Vector& normal) {
  const Loop& hole = holes.front();
  double shortest = std::numeric_limits<double>::infinity();
  std::pair<std::size_t, std::size_t> ends;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const double length = (scene.vertices[outline[i]] - scene.vertices[hole[j]]).norm();
      if (length >= shortest || !is_free(scene, outline[i], hole[j], outline, normal)) continue;
      if (!std::all_of(holes.begin(), holes.end(),
                       [&](const Loop& other) { return is_free(scene, outline[i], hole[j], other, normal); }))
        continue;
      shortest = length;
      ends = {i, j};
    }
  }
  if (!std::isfinite(shortest)) return std::nullopt;
  Loop result;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    result.push_back(outline[i]);
    if (i != ends.first) continue;
    for (std::size_t j = 0; j <= hole.size(); ++j) result.push_back(hole[(ends.second + j) % hole.size()]);
    result.push_back(outline[i]);
  }
  return result;
}

// The wall with holes that run against its outline; nothing where one of them does not lie within it, apart from
// others.
std::optional<Loop> with_holes(const Scene& scene, const Loop& wall, const std::vector<Loop>& panes, double near) {
  const std::vector<Point> outline = points_of(scene, wall);
  const Vector normal = area_vector(outline).normalized();
  std::vector<Loop> holes;
  for (Loop hole : panes) {
    if (area_vector(points_of(scene, hole)).dot(normal) > 0) std::reverse(hole.begin(), hole.end());
    if (outlines_meet(scene, wall, hole, normal, near)) return std::nullopt;
    if (!contains(outline, scene.vertices[hole.front()])) return std::nullopt;
    for (const Loop& other : holes) {
      if (outlines_meet(scene, other, hole, normal, near)) return std::nullopt;
    }
    holes.push_back(std::move(hole));
  }
  Loop cut = wall;
  for (std::size_t k = 0; k < holes.size(); ++k) {
    std::optional<Loop> next = joined(scene, cut, std::span(holes).subspan(k), normal);
    if (!next) return std::nullopt;
    cut = std::move(*next);
  }
  return cut;
}

std::vector<std::vector<Point>> in_pieces(const Scene& scene, const Loop& wall, const std::vector<Loop>& panes,
                                          double width) {
  const std::vector<Point> outline = points_of(scene, wall);
  std::vector<std::vector<Point>> pieces;
  for (const auto& [a, b, c] : triangulate(outline)) pieces.push_back({outline[a], outline[b], outline[c]});
  for (const Loop& pane : panes) {
    const std::vector<Point> points = points_of(scene, pane);
    for (const auto& [a, b, c] : triangulate(points)) pieces = beside(pieces, {points[a], points[b], points[c]}, width);
  }
  return pieces;
}

// The outlines of the clear faces that lie over an opaque one.
std::vector<Loop> panes_over(const Scene& scene, const Coverings& coverings, PolygonIndex wall) {
  std::vector<PolygonIndex> over;
  if (is_opening(scene, wall)) return {};
  for (const Side side : {Side::front, Side::back}) {
    for (const PolygonIndex other : coverings.over_side(wall, side)) {
      if (is_opening(scene, other) && std::find(over.begin(), over.end(), other) == over.end()) over.push_back(other);
    }
  }
  std::vector<Loop> panes;
  for (const PolygonIndex pane : over) panes.push_back(scene.polygons[pane].corners);
  return panes;
}

// A wall without what lies under the panes.
Pieces opened(const Scene& scene, const Polygon& wall, const std::vector<Loop>& panes, double near) {
  Pieces pieces;
  Polygon part = wall;
  if (std::optional<Loop> cut = with_holes(scene, wall.corners, panes, near)) {
    part.corners = std::move(*cut);
    pieces.polygons.push_back(std::move(part));
    return pieces;
  }
  for (const std::vector<Point>& piece : in_pieces(scene, wall.corners, panes, near)) {
    part.corners.clear();
    for (const Point& corner : piece) {
      part.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size() + pieces.new_vertices.size()));
      pieces.new_vertices.push_back(corner);
    }
    pieces.polygons.push_back(part);
  }
  return pieces;
}

}  // namespace

Scene with_openings_cut(Scene scene) {
  const auto count = static_cast<PolygonIndex>(scene.polygons.size());
  bool any = false;
  for (PolygonIndex p = 0; p < count && !any; ++p) any = is_opening(scene, p);
  if (!any) return scene;
  KeptSides all;
  all.front.assign(count, 1);
  all.back.assign(count, 1);
  const Coverings coverings = find_coverings(scene, all);
  const double near = weld_distance(scene);
  std::vector<ModelFace> cut;
  std::vector<Polygon> polygons;
  for (PolygonIndex p = 0; p < count; ++p) {
    const std::vector<Loop> panes = panes_over(scene, coverings, p);
    if (panes.empty()) {
      polygons.push_back(scene.polygons[p]);
      continue;
    }
    cut.push_back(model_face(scene, scene.polygons[p]));
    Pieces pieces = opened(scene, scene.polygons[p], panes, near);
    scene.vertices.insert(scene.vertices.end(), pieces.new_vertices.begin(), pieces.new_vertices.end());
    for (Polygon& part : pieces.polygons) polygons.push_back(std::move(part));
  }
  scene.polygons = std::move(polygons);
  if (cut.empty()) return scene;
  const std::string what = listed(scene, cut) + " under a clear one in the same plane: opened there";
  scene.diagnostics.push_back({DiagnosticCode::overlapping_faces, what, cut.size(), std::move(cut)});
  return scene;
}

}  // namespace patchlight
