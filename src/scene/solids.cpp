#include "scene/solids.h"

#include "base/tolerances.h"
#include "scene/face_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <variant>

namespace patchlight {
namespace {

// Tests of boxes and triangles, about 10 ns each.
constexpr double most_tests = 2e7;

// No vertex lies before a face as seen from inside. Only then a polygon with all corners in a solid lies in it.
bool is_convex(const Solid& solid) {
  const double tolerance = tolerance_of_coordinates * solid.box.diagonal().norm();
  const double outward = solid.fronts_face_inside ? -1 : 1;
  return std::all_of(solid.triangles.begin(), solid.triangles.end(), [&](const Triangle& of) {
    const Vector normal = outward * (of[1] - of[0]).cross(of[2] - of[0]).normalized();
    return std::all_of(solid.triangles.begin(), solid.triangles.end(), [&](const Triangle& other) {
      return std::all_of(other.begin(), other.end(),
                         [&](const Point& vertex) { return normal.dot(vertex - of[0]) < tolerance; });
    });
  });
}

bool lies_within(const Scene& scene, PolygonIndex polygon, Side side, const Solid& solid) {
  const double extent = solid.box.diagonal().norm();
  const std::vector<Point> corners = corners_before(scene, polygon, side, extent);
  return holds(solid, point_before(scene, polygon, side, extent)) &&
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

LampShape shape_of_side(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  std::vector<Point> corners = corner_points(scene, polygon);
  LampShape shape;
  const Vector step = step_before(scene, polygon, side, extent);
  for (Point& corner : corners) shape.box.extend(corner += step);
  shape.triangles = triangles_of(corners);
  shape.middle = point_before(scene, polygon, side, extent);
  return shape;
}

LampShape shape_of(const Luminaire& luminaire) {
  LampShape shape;
  shape.middle = luminaire.position;
  if (const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light)) shape.radius = sphere->radius;
  shape.box = with_margin(Box(shape.middle), shape.radius);
  return shape;
}

bool comes_near(const Point& point, const Solid& solid, double reach) {
  if (!with_margin(solid.box, reach).contains(point)) return false;
  return std::any_of(solid.triangles.begin(), solid.triangles.end(),
                     [&](const Triangle& triangle) { return distance_to(triangle, point) <= reach; });
}

// The length of the part of a segment that lies in a triangle of the same plane, made wider by `margin`.
double length_within(const std::array<Point, 2>& segment, const Triangle& triangle, const Vector& normal,
                     double margin) {
  double first = 0;
  double last = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector inward = normal.cross(triangle[(k + 1) % 3] - triangle[k]).normalized();
    const double from = inward.dot(segment[0] - triangle[k]) + margin;
    const double to = inward.dot(segment[1] - triangle[k]) + margin;
    if (from < 0 && to < 0) return 0;
    if (from < 0) first = std::max(first, from / (from - to));
    if (to < 0) last = std::min(last, from / (from - to));
  }
  return std::max(0.0, last - first) * (segment[1] - segment[0]).norm();
}

// Does a triangle of a lamp pass through one of a solid, farther than `near` on either side? Where it does, it crosses
// the plane of the latter in a segment.
bool passes_through(const Triangle& lamp, const Triangle& triangle, double near) {
  const Vector normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  std::array<double, 3> height{};
  for (std::size_t k = 0; k < 3; ++k) height[k] = normal.dot(lamp[k] - triangle[0]);
  const auto [lowest, highest] = std::minmax_element(height.begin(), height.end());
  if (!(*lowest<-near&& * highest> near)) return false;
  std::array<Point, 2> crossing;
  std::size_t ends = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if ((height[k] < 0) == (height[next] < 0)) continue;
    crossing[ends++] = lamp[k] + height[k] / (height[k] - height[next]) * (lamp[next] - lamp[k]);
  }
  // A shorter way through only touches its outline.
  return length_within(crossing, triangle, normal, near) > 8 * near;
}

bool passes_through(const LampShape& lamp, const Solid& solid, double near) {
  for (const Triangle& triangle : solid.triangles) {
    Box box(triangle[0]);
    box.extend(triangle[1]).extend(triangle[2]);
    if (!with_margin(box, near).intersects(lamp.box)) continue;
    for (const Triangle& part : lamp.triangles) {
      if (passes_through(part, triangle, near)) return true;
    }
  }
  return false;
}

LampPlaces places_of(const LampShape& lamp, const Solid& solid, double near) {
  if (!with_margin(solid.box, near).intersects(lamp.box)) return {.inside = false, .outside = true};
  if (comes_near(lamp.middle, solid, lamp.radius + near) || passes_through(lamp, solid, near))
    return {.inside = true, .outside = true};
  const bool is_inside = holds(solid, lamp.middle);
  return {.inside = is_inside, .outside = !is_inside};
}

}  // namespace

std::optional<Solid> solid_of(const Scene& scene, std::vector<PolygonIndex> polygons, const Shells& shells,
                              std::vector<Triangle> lids) {
  Solid solid;
  solid.triangles = std::move(lids);
  for (const PolygonIndex p : polygons) {
    std::vector<Point> corners = corner_points(scene, p);
    solid.has_opening = solid.has_opening || is_opening(scene, p) || is_sheet(scene, p);
    for (const Point& corner : corners) solid.box.extend(corner);
    if (shells.turned[p]) std::reverse(corners.begin(), corners.end());
    const std::vector<Triangle> triangles = triangles_of(corners);
    solid.triangles.insert(solid.triangles.end(), triangles.begin(), triangles.end());
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
  // The fold of two coincident polygons encloses no volume.
  if (std::abs(volume) <= tolerance_of_shapes * area * solid.box.diagonal().norm()) return std::nullopt;
  return solid;
}

namespace {

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

}  // namespace

SceneGeometry compute_geometry(const Scene& scene) {
  SceneGeometry geometry;
  geometry.shells = shells_of(scene);
  geometry.solids = closed_solids(scene, geometry.shells);
  geometry.inner = inner_sides(scene, geometry.shells, geometry.solids);
  return geometry;
}

std::shared_ptr<const SceneGeometry> geometry_of(const Scene& scene, const KeptSides& kept) {
  return kept.geometry ? kept.geometry : std::make_shared<const SceneGeometry>(compute_geometry(scene));
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
  return (side == Side::front ? tolerance_of_coordinates : -tolerance_of_coordinates) * extent *
         front_normal(scene, polygon);
}

Point point_before(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  return inner_point(corner_points(scene, polygon)) + step_before(scene, polygon, side, extent);
}

std::vector<Point> corners_before(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  std::vector<Point> corners = corner_points(scene, polygon);
  const Point middle = inner_point(corners);
  const Vector step = step_before(scene, polygon, side, extent);
  for (Point& corner : corners) corner += 1e-4 * (middle - corner) + step;
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
  std::vector<Box> boxes;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) boxes.push_back(polygon_box(scene, p));
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

// Ericson 2005, Real-Time Collision Detection, section 5.1.5, by the regions of the plane: the nearest point lies in
// the triangle or on one of its edges.
double distance_to(const Triangle& triangle, const Point& point) {
  const auto& [a, b, c] = triangle;
  const Vector normal = (b - a).cross(c - a);
  bool within = normal.squaredNorm() > 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& from = triangle[k];
    const Vector edge = triangle[(k + 1) % 3] - from;
    const double length = edge.squaredNorm();
    const double along = length > 0 ? std::clamp(edge.dot(point - from) / length, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (point - from - along * edge).norm());
    within = within && normal.cross(edge).dot(point - from) >= 0;
  }
  return within ? std::min(nearest, std::abs(normal.normalized().dot(point - a))) : nearest;
}

double distance_to(const Solid& solid, const Point& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : solid.triangles) least = std::min(least, distance_to(triangle, point));
  return least;
}

std::vector<LampShape> lamp_shapes(const Scene& scene, double extent) {
  std::vector<LampShape> shapes;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (emits(scene, p, side)) shapes.push_back(shape_of_side(scene, p, side, extent));
    }
  }
  for (const Luminaire& luminaire : scene.luminaires) shapes.push_back(shape_of(luminaire));
  return shapes;
}

LampPlaces places_of(const std::vector<LampShape>& lamps, const Solid& solid, double extent) {
  // Half of the way by which point_before() steps off a side, so that a lamp never lies on the polygon it shines from.
  const double near = tolerance_of_coordinates / 2 * extent;
  LampPlaces all;
  for (const LampShape& lamp : lamps) {
    const LampPlaces one = places_of(lamp, solid, near);
    all.inside = all.inside || one.inside;
    all.outside = all.outside || one.outside;
    if (all.inside && all.outside) return all;
  }
  return all;
}

}  // namespace patchlight
