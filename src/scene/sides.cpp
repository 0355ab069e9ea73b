#include "patchlight/scene/sides.h"

#include "patchlight/scene/shells.h"

#include "scene/solids.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// A point just before every side that emits, and that of every luminaire.
std::vector<Point> points_of_lamps(const Scene& scene) {
  const double extent = bounds(scene).diagonal().norm();
  std::vector<Point> points;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (emits(scene, p, side)) points.push_back(point_before(scene, p, side, extent));
    }
  }
  for (const Luminaire& luminaire : scene.luminaires) points.push_back(luminaire.position);
  return points;
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

std::string name_of_solid(const Scene& scene, const Solid& solid) {
  const Polygon& first = scene.polygons[solid.polygons.front()];
  return std::string("'")
      .append(group_name(scene, first.group))
      .append("' (")
      .append(place_of(scene, first))
      .append(")");
}

// Leaves out the sides that face the inside of these solids, unless they are wanted, and counts them.
KeptSides without_unreached(KeptSides kept, const Scene& scene, const std::vector<std::uint8_t>& within, bool wanted) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (!within[2 * p + static_cast<std::size_t>(side)]) continue;
      ++kept.unreached;
      (side == Side::front ? kept.front : kept.back)[p] = wanted;
    }
  }
  return kept;
}

KeptSides automatic_sides(const Scene& scene, const KeptInTheDark& in_the_dark) {
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 1);
  kept.back.assign(scene.polygons.size(), 1);
  const std::vector<Point> lamps = points_of_lamps(scene);
  const bool daylight = scene.sun || scene.sky;
  const Shells shells = shells_of(scene);
  Count count;
  std::vector<Solid> dark;
  for (Solid& solid : closed_solids(scene, shells)) {
    const auto held = static_cast<std::size_t>(
        std::count_if(lamps.begin(), lamps.end(), [&](const Point& lamp) { return holds(solid, lamp); }));
    const bool lit_from_outside = daylight || held < lamps.size();
    const bool lit_inside = held > 0 || (lit_from_outside && solid.has_opening);
    const bool lit_outside = held == 0 || lit_from_outside;
    for (const PolygonIndex p : solid.polygons) {
      const bool inner_is_front = inner_side(solid, shells, p) == Side::front;
      if (!lit_outside) (inner_is_front ? kept.back : kept.front)[p] = in_the_dark.turned_away;
    }
    if (!lit_outside) kept.turned_away += solid.polygons.size();
    if (lit_inside && !solid.fronts_face_inside && count.outward++ == 0) {
      count.first_outward_line = scene.polygons[solid.polygons[0]].line;
    }
    count.dark += !lit_inside && !in_the_dark.unreached;
    count.outside += !lit_outside && !in_the_dark.turned_away;
    if (lit_inside) continue;
    kept.dark_solids.push_back({name_of_solid(scene, solid), solid.polygons.size()});
    dark.push_back(std::move(solid));
  }
  kept.notes = notes_on(count);
  // Where nothing is lit, what stands in a dark solid is no darker than the rest.
  const bool any_light = daylight || !lamps.empty();
  const auto within = any_light ? sides_within(scene, shells, dark) : inner_sides(scene, shells, dark);
  return without_unreached(std::move(kept), scene, within, in_the_dark.unreached);
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

KeptSides kept_sides(const Scene& scene, Sides sides, const KeptInTheDark& in_the_dark) {
  if (sides == Sides::automatic) return automatic_sides(scene, in_the_dark);
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
