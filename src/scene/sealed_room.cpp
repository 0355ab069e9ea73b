#include "scene/sealed_room.h"

#include "scene/extent.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr double under_top = 0.1;  // of the room's height

// Faces that look down by this much or more are of a ceiling.
constexpr double cosine_of_ceiling = 0.7;

// Triangles that are looked at, some 50 ns each, unless that is too few for this many points.
constexpr std::size_t most_looked_at = 10'000'000;
constexpr std::size_t fewest_points = 16;

// Of how many points it is asked whether the solid holds them.
std::size_t most_points(const Solid& solid) { return std::max(fewest_points, most_looked_at / solid.triangles.size()); }

// So many of them, spread evenly over all.
std::vector<PolygonIndex> spread_evenly(const std::vector<PolygonIndex>& polygons, std::size_t count) {
  if (polygons.size() <= count) return polygons;
  std::vector<PolygonIndex> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(polygons[k * polygons.size() / count]);
  return chosen;
}

// One polygon of each shell but that of the hull, without what lies far from the scene.
std::vector<PolygonIndex> other_shells(const Scene& scene, const Shells& shells, const Solid& hull) {
  const std::vector<PolygonIndex> far = far_polygons(scene);
  const PolygonIndex of_hull = shells.shell[hull.polygons.front()];
  std::vector<PolygonIndex> others;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const bool is_first = shells.shell[p] == p && p != of_hull;
    if (is_first && !std::binary_search(far.begin(), far.end(), p)) others.push_back(p);
  }
  return others;
}

// Is all else inside? What lies on the hull has one of its sides inside.
bool holds_all_else(const Scene& scene, const Shells& shells, const Solid& hull, double extent) {
  const std::vector<PolygonIndex> others = spread_evenly(other_shells(scene, shells, hull), most_points(hull));
  return std::all_of(others.begin(), others.end(), [&](PolygonIndex p) {
    return holds(hull, point_before(scene, p, Side::front, extent)) ||
           holds(hull, point_before(scene, p, Side::back, extent));
  });
}

struct CeilingTriangle {
  double area = 0;  // twice its area, m^2
  Point middle;
};

// The triangles of a room that look down into it, the largest first, at most so many.
std::vector<CeilingTriangle> largest_of_ceiling(const Scene& scene, const Solid& room, std::size_t count) {
  std::vector<CeilingTriangle> ceiling;
  for (const auto& [a, b, c] : room.triangles) {
    const Vector inward = (room.fronts_face_inside ? 1.0 : -1.0) * (b - a).cross(c - a);
    const double area = inward.norm();
    if (area > 0 && -inward.dot(scene.up) >= cosine_of_ceiling * area) ceiling.push_back({area, (a + b + c) / 3});
  }
  std::stable_sort(ceiling.begin(), ceiling.end(),
                   [](const CeilingTriangle& a, const CeilingTriangle& b) { return a.area > b.area; });
  if (ceiling.size() > count) ceiling.resize(count);
  return ceiling;
}

}  // namespace

std::optional<Solid> sealed_hull(const Scene& scene) {
  const Box all = main_bounds(scene);
  const double extent = extent_of(scene);
  const Vector touching = Vector::Constant(weld_distance(scene));
  const Shells shells = shells_of(scene);
  for (Solid& solid : closed_solids(scene, shells)) {
    const Box box(solid.box.min() - touching, solid.box.max() + touching);
    if (!solid.has_opening && box.contains(all) && holds_all_else(scene, shells, solid, extent))
      return std::move(solid);
  }
  return std::nullopt;
}

bool is_room(const Scene& scene, const Solid& hull) {
  return hull.fronts_face_inside || hull.polygons.size() < scene.polygons.size() || !scene.rooms.empty();
}

std::optional<Point> place_under_ceiling(const Scene& scene, const Solid& room) {
  const double height = room.box.sizes().dot(scene.up.cwiseAbs());
  // Over the middle.
  const Point over_middle = room.box.center() + (0.5 - under_top) * height * scene.up;
  if (holds(room, over_middle)) return over_middle;

  // Under the largest part of the ceiling.
  for (const CeilingTriangle& part : largest_of_ceiling(scene, room, most_points(room))) {
    const Point below = part.middle - under_top * height * scene.up;
    if (holds(room, below)) return below;
  }
  return std::nullopt;
}

}  // namespace patchlight
