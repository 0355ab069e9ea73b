#include "scene/solids.h"

#include "scene/triangulate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

namespace patchlight {
namespace {

// How far before its side a point is looked for, as a share of the scene's extent.
constexpr double step_off_surface = 1e-6;

// Corners that touch a wall are looked for nearer to the middle by this share.
constexpr double inset = 1e-4;

// A closed surface encloses a volume when it is larger than this share of its area times its extent; the fold of two
// coincident polygons does not.
constexpr double volume_tolerance = 1e-9;

// Tests of boxes and triangles, some 10 ns each.
constexpr double most_tests = 2e7;

Point inner_point(const std::vector<Point>& corners) {
  double largest = 0;
  Point middle = corners[0];
  for (const auto& [a, b, c] : triangulate(corners)) {
    const double area = (corners[b] - corners[a]).cross(corners[c] - corners[a]).norm();
    if (area <= largest) continue;
    largest = area;
    middle = (corners[a] + corners[b] + corners[c]) / 3;
  }
  return middle;
}

// No vertex lies before a face as seen from inside. What has its corners in a solid lies in it as a whole only then.
bool is_convex(const Solid& solid) {
  const double tolerance = step_off_surface * solid.box.diagonal().norm();
  const double outward = solid.fronts_face_inside ? -1 : 1;
  return std::all_of(solid.triangles.begin(), solid.triangles.end(), [&](const std::array<Point, 3>& of) {
    const Vector normal = outward * (of[1] - of[0]).cross(of[2] - of[0]).normalized();
    return std::all_of(solid.triangles.begin(), solid.triangles.end(), [&](const std::array<Point, 3>& other) {
      return std::all_of(other.begin(), other.end(),
                         [&](const Point& vertex) { return normal.dot(vertex - of[0]) < tolerance; });
    });
  });
}

bool lies_within(const Scene& scene, PolygonIndex polygon, Side side, const Solid& solid) {
  const double extent = solid.box.diagonal().norm();
  const Vector step = step_before(scene, polygon, side, extent);
  const std::vector<Point> corners = corners_before(scene, polygon, side, extent);
  return holds(solid, inner_point(corner_points(scene, polygon)) + step) &&
         std::all_of(corners.begin(), corners.end(), [&](const Point& corner) { return holds(solid, corner); });
}

// Indices of the solids, those with the largest boxes first.
std::vector<std::size_t> largest_first(std::span<const Solid> solids) {
  std::vector<std::size_t> order(solids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return solids[a].box.volume() > solids[b].box.volume(); });
  return order;
}

std::vector<Box> boxes_of(const Scene& scene) {
  std::vector<Box> boxes(scene.polygons.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const std::uint32_t corner : scene.polygons[p].corners) boxes[p].extend(scene.vertices[corner]);
  }
  return boxes;
}

}  // namespace

std::optional<Solid> solid_of(const Scene& scene, std::vector<PolygonIndex> polygons, const Shells& shells,
                              std::vector<std::array<Point, 3>> lids) {
  Solid solid;
  solid.triangles = std::move(lids);
  for (const PolygonIndex p : polygons) {
    std::vector<Point> corners = corner_points(scene, p);
    solid.has_opening = solid.has_opening || is_opening(scene, p) || is_sheet(scene, p);
    for (const Point& corner : corners) solid.box.extend(corner);
    if (shells.turned[p]) std::reverse(corners.begin(), corners.end());
    for (const auto& [a, b, c] : triangulate(corners)) solid.triangles.push_back({corners[a], corners[b], corners[c]});
  }
  solid.polygons = std::move(polygons);

  // V = 1/6 sum (a - o) . ((b - o) x (c - o)), positive when the fronts face outward.
  const Point origin = solid.box.center();
  double volume = 0;
  double area = 0;
  for (const auto& [a, b, c] : solid.triangles) {
    volume += (a - origin).dot((b - origin).cross(c - origin)) / 6;
    area += (b - a).cross(c - a).norm() / 2;
  }
  solid.fronts_face_inside = volume < 0;
  if (std::abs(volume) <= volume_tolerance * area * solid.box.diagonal().norm()) return std::nullopt;
  return solid;
}

std::vector<Solid> closed_solids(const Scene& scene, const Shells& shells) {
  std::vector<std::vector<PolygonIndex>> members(scene.polygons.size());
  for (PolygonIndex p = 0; p < members.size(); ++p) {
    if (shells.closed[p]) members[shells.shell[p]].push_back(p);
  }
  std::vector<Solid> solids;
  for (std::vector<PolygonIndex>& polygons : members) {
    if (polygons.empty()) continue;
    std::optional<Solid> solid = solid_of(scene, std::move(polygons), shells);
    if (solid) solids.push_back(std::move(*solid));
  }
  return solids;
}

Side inner_side(const Solid& solid, const Shells& shells, PolygonIndex polygon) {
  return solid.fronts_face_inside != (shells.turned[polygon] != 0) ? Side::front : Side::back;
}

bool holds(const Solid& solid, const Point& point) {
  if (!solid.box.contains(point)) return false;
  double solid_angle = 0;
  for (const auto& [a, b, c] : solid.triangles) solid_angle += signed_solid_angle(point, a, b, c);
  return std::abs(std::lround(solid_angle / (4 * std::numbers::pi))) == 1;
}

Vector step_before(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  return (side == Side::front ? step_off_surface : -step_off_surface) * extent * front_normal(scene, polygon);
}

Point point_before(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  return inner_point(corner_points(scene, polygon)) + step_before(scene, polygon, side, extent);
}

std::vector<Point> corners_before(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  std::vector<Point> corners = corner_points(scene, polygon);
  const Point middle = inner_point(corners);
  const Vector step = step_before(scene, polygon, side, extent);
  for (Point& corner : corners) corner += inset * (middle - corner) + step;
  return corners;
}

std::vector<std::uint8_t> inner_sides(const Scene& scene, const Shells& shells, std::span<const Solid> solids) {
  std::vector<std::uint8_t> within(2 * scene.polygons.size(), 0);
  for (const Solid& solid : solids) {
    for (const PolygonIndex p : solid.polygons) {
      within[2 * std::size_t{p} + static_cast<std::size_t>(inner_side(solid, shells, p))] = 1;
    }
  }
  return within;
}

std::vector<std::uint8_t> sides_within(const Scene& scene, const Shells& shells, std::span<const Solid> solids) {
  std::vector<std::uint8_t> within = inner_sides(scene, shells, solids);
  const std::vector<Box> boxes = boxes_of(scene);
  double tests = 0;
  for (const std::size_t k : largest_first(solids)) {
    const Solid& solid = solids[k];
    const auto triangles = static_cast<double>(solid.triangles.size());
    tests += triangles * triangles;
    if (tests > most_tests) return within;
    if (!is_convex(solid)) continue;
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      if (++tests > most_tests) return within;
      if (!solid.box.contains(boxes[p]) || shells.shell[p] == shells.shell[solid.polygons.front()]) continue;
      tests += 2.0 * static_cast<double>((scene.polygons[p].corners.size() + 1) * solid.triangles.size());
      if (tests > most_tests) return within;
      for (const Side side : {Side::front, Side::back}) {
        std::uint8_t& is_within = within[2 * std::size_t{p} + static_cast<std::size_t>(side)];
        if (!is_within && lies_within(scene, p, side, solid)) is_within = 1;
      }
    }
  }
  return within;
}

}  // namespace patchlight
