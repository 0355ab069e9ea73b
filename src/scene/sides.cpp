#include "patchlight/scene/sides.h"

#include "patchlight/scene/shells.h"
#include "patchlight/scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

// How far before its front a lamp is looked for, as a share of the scene's extent.
constexpr double lamp_offset = 1e-6;

// A closed surface encloses a volume when it is larger than this share of its area times its extent; the fold of two
// coincident polygons does not.
constexpr double volume_tolerance = 1e-9;

// A closed set of polygons, consistently oriented once those that are turned are turned back.
struct Solid {
  std::vector<PolygonIndex> polygons;
  bool fronts_face_inside = false;  // those of the polygons that are not turned
  bool has_opening = false;
  Box box;
  std::vector<std::array<Point, 3>> triangles;  // oriented as the polygons
};

// The solid of these polygons with its triangles and the direction its fronts face; no triangles if it has no volume.
Solid make_solid(const Scene& scene, std::vector<PolygonIndex> polygons, const std::vector<std::uint8_t>& turned) {
  Solid solid;
  for (const PolygonIndex p : polygons) {
    std::vector<Point> corners = corner_points(scene, p);
    solid.has_opening = solid.has_opening || is_opening(scene, p);
    for (const Point& corner : corners) solid.box.extend(corner);
    if (turned[p]) std::reverse(corners.begin(), corners.end());
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
  if (std::abs(volume) <= volume_tolerance * area * solid.box.diagonal().norm()) solid.triangles.clear();
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
    Solid solid = make_solid(scene, std::move(polygons), shells.turned);
    if (!solid.triangles.empty()) solids.push_back(std::move(solid));
  }
  return solids;
}

// The middle of a polygon's largest triangle, which is inside the polygon even when that is not convex.
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

// A point just before every side that emits, and that of every luminaire.
std::vector<Point> points_of_lamps(const Scene& scene) {
  const double offset = lamp_offset * bounds(scene).diagonal().norm();
  std::vector<Point> points;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_lamp(scene, p)) continue;
    const Point middle = inner_point(corner_points(scene, p));
    const Vector step = offset * front_normal(scene, p);
    if (emits(scene, p, Side::front)) points.push_back(middle + step);
    if (emits(scene, p, Side::back)) points.push_back(middle - step);
  }
  for (const Luminaire& luminaire : scene.luminaires) points.push_back(luminaire.position);
  return points;
}

bool holds(const Solid& solid, const Point& point) {
  if (!solid.box.contains(point)) return false;
  double solid_angle = 0;
  for (const auto& [a, b, c] : solid.triangles) solid_angle += signed_solid_angle(point, a, b, c);
  return std::abs(std::lround(solid_angle / (4 * std::numbers::pi))) == 1;
}

// Counts for the notes.
struct Count {
  int dark = 0;     // solids without a lamp: inner sides left out
  int outside = 0;  // solids that hold every lamp: outer sides left out
  int outward = 0;  // solids with outward normals that hold a lamp: inner sides kept
  std::uint32_t first_outward_line = 0;
};

std::vector<std::string> notes_on(const Count& count) {
  const auto solids = [](int number) {
    return std::to_string(number) + (number == 1 ? " closed solid" : " closed solids");
  };
  std::vector<std::string> notes;
  if (count.dark > 0) notes.push_back("the inner sides of " + solids(count.dark) + " without a lamp are left out");
  if (count.outside > 0) {
    notes.push_back("the outer sides of " + solids(count.outside) + " around all lamps are left out");
  }
  if (count.outward > 0) {
    const std::string line =
        count.first_outward_line > 0 ? " (line " + std::to_string(count.first_outward_line) + ")" : std::string();
    notes.push_back(solids(count.outward) + line + " with outward normals around a lamp: the inner sides are used");
  }
  return notes;
}

KeptSides automatic_sides(const Scene& scene) {
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 1);
  kept.back.assign(scene.polygons.size(), 1);
  const std::vector<Point> lamps = points_of_lamps(scene);
  const bool daylight = scene.sun || scene.sky;
  const Shells shells = shells_of(scene);
  Count count;
  for (const Solid& solid : closed_solids(scene, shells)) {
    const auto held = static_cast<std::size_t>(
        std::count_if(lamps.begin(), lamps.end(), [&](const Point& lamp) { return holds(solid, lamp); }));
    const bool lit_from_outside = daylight || held < lamps.size();
    const bool keep_inside = held > 0 || (lit_from_outside && solid.has_opening);
    const bool keep_outside = held == 0 || lit_from_outside;
    for (const PolygonIndex p : solid.polygons) {
      const bool front_faces_inside = solid.fronts_face_inside != (shells.turned[p] != 0);
      kept.front[p] = front_faces_inside ? keep_inside : keep_outside;
      kept.back[p] = front_faces_inside ? keep_outside : keep_inside;
    }
    count.dark += !keep_inside;
    count.outside += !keep_outside;
    if (keep_inside && !solid.fronts_face_inside && count.outward++ == 0) {
      count.first_outward_line = scene.polygons[solid.polygons[0]].line;
    }
  }
  kept.notes = notes_on(count);
  return kept;
}

}  // namespace

const char* name_of(Sides sides) {
  switch (sides) {
    case Sides::automatic:
      return "auto";
    case Sides::front:
      return "front";
    case Sides::both:
      return "both";
  }
  return "";
}

KeptSides kept_sides(const Scene& scene, Sides sides) {
  if (sides == Sides::automatic) return automatic_sides(scene);
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 1);
  for (const Polygon& polygon : scene.polygons) {
    kept.back.push_back(sides == Sides::both || polygon.back_material.has_value() ? 1 : 0);
  }
  kept.emit_from_back = sides == Sides::both;
  if (kept.emit_from_back) kept.notes.push_back("lamps emit from both sides: twice the flux of their front sides");
  return kept;
}

double kept_area(const Scene& scene, const KeptSides& sides) {
  double area = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    area += (sides.front[p] + sides.back[p]) * area_vector(corner_points(scene, p)).norm();
  }
  return area;
}

}  // namespace patchlight
