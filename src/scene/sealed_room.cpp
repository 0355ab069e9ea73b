#include "scene/sealed_room.h"

#include "scene/extent.h"

#include <cmath>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr double under_top = 0.1;  // of the room's height

// Faces that look down by this much or more are of a ceiling.
constexpr double cosine_of_ceiling = 0.7;

}  // namespace

std::optional<Solid> sealed_hull(const Scene& scene) {
  const Box all = main_bounds(scene);
  const Vector touching = Vector::Constant(weld_distance(scene));
  for (Solid& solid : closed_solids(scene, shells_of(scene))) {
    const Box box(solid.box.min() - touching, solid.box.max() + touching);
    if (!solid.has_opening && box.contains(all)) return std::move(solid);
  }
  return std::nullopt;
}

bool is_room(const Scene& scene, const Solid& hull) {
  return hull.fronts_face_inside || hull.polygons.size() < scene.polygons.size() || !scene.rooms.empty();
}

Point place_under_ceiling(const Scene& scene, const Solid& room) {
  const double height = room.box.sizes().dot(scene.up.cwiseAbs());
  // Over the middle.
  Point place = room.box.center() + (0.5 - under_top) * height * scene.up;
  if (holds(room, place)) return place;

  // Under the largest part of the ceiling. A place under the floor is outside.
  double largest = 0;
  const double extent = extent_of(scene);
  for (const PolygonIndex p : room.polygons) {
    const double area = area_vector(corner_points(scene, p)).norm();
    if (area <= largest || std::abs(front_normal(scene, p).dot(scene.up)) < cosine_of_ceiling) continue;
    const Point below = point_before(scene, p, Side::front, extent) - under_top * height * scene.up;
    if (!holds(room, below)) continue;
    largest = area;
    place = below;
  }
  return place;
}

}  // namespace patchlight
