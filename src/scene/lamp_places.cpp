#include "scene/lamp_places.h"

#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

namespace patchlight {
namespace {

// Half of the way by which point_before() steps off a side, so that a lamp never lies on the polygon it shines from.
constexpr double nearness = 5e-7;

// A lamp that passes through a triangle by less than so many times the nearness only touches its outline.
constexpr double touching_lengths = 8;

Box with_margin(const Box& box, double margin) {
  const Vector all = Vector::Constant(margin);
  return {box.min() - all, box.max() + all};
}

LampShape shape_of_side(const Scene& scene, PolygonIndex polygon, Side side, double extent) {
  std::vector<Point> corners = corner_points(scene, polygon);
  LampShape shape;
  const Vector step = step_before(scene, polygon, side, extent);
  for (Point& corner : corners) shape.box.extend(corner += step);
  for (const auto& [a, b, c] : triangulate(corners)) shape.triangles.push_back({corners[a], corners[b], corners[c]});
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
                     [&](const std::array<Point, 3>& triangle) { return distance_to(triangle, point) <= reach; });
}

// The length of the part of a segment that lies in a triangle of the same plane, made wider by `margin`.
double length_within(const std::array<Point, 2>& segment, const std::array<Point, 3>& triangle, const Vector& normal,
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
bool passes_through(const std::array<Point, 3>& lamp, const std::array<Point, 3>& triangle, double near) {
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
  return length_within(crossing, triangle, normal, near) > touching_lengths * near;
}

bool passes_through(const LampShape& lamp, const Solid& solid, double near) {
  for (const std::array<Point, 3>& triangle : solid.triangles) {
    Box box(triangle[0]);
    box.extend(triangle[1]).extend(triangle[2]);
    if (!with_margin(box, near).intersects(lamp.box)) continue;
    for (const std::array<Point, 3>& part : lamp.triangles) {
      if (passes_through(part, triangle, near)) return true;
    }
  }
  return false;
}

LampPlaces places_of(const LampShape& lamp, const Solid& solid, double near) {
  if (!with_margin(solid.box, near).intersects(lamp.box)) return {.inside = false, .outside = true};
  if (comes_near(lamp.middle, solid, lamp.radius + near) || passes_through(lamp, solid, near))
    return {.inside = true, .outside = true};
  const bool held = holds(solid, lamp.middle);
  return {.inside = held, .outside = !held};
}

}  // namespace

// Ericson 2005, Real-Time Collision Detection, section 5.1.5, by the regions of the plane: the nearest point lies in
// the triangle or on one of its edges.
double distance_to(const std::array<Point, 3>& triangle, const Point& point) {
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
  for (const std::array<Point, 3>& triangle : solid.triangles) least = std::min(least, distance_to(triangle, point));
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
  LampPlaces all;
  for (const LampShape& lamp : lamps) {
    const LampPlaces one = places_of(lamp, solid, nearness * extent);
    all.inside = all.inside || one.inside;
    all.outside = all.outside || one.outside;
    if (all.inside && all.outside) return all;
  }
  return all;
}

}  // namespace patchlight
