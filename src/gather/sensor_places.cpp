#include "gather/sensor_places.h"

#include "base/parallel.h"
#include "gather/facets.h"
#include "gather/walls.h"
#include "scene/extent.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

// A sensor lies on a polygon when it is nearer to it than this share of the polygon's size: coordinates are often
// written with five or six digits.
constexpr double share_of_polygon = 1e-5;
// Or than this share of the scene's extent, ten times the resolution of shadow rays.
constexpr double share_of_scene = 1e-6;

// A sensor that faces along the normal, with a cosine so near to 1, sends no ray to where the polygon hides something:
// it is read next to it, just far enough for the occluder to know on which side.
constexpr double along_normal = 1 - 1e-6;
constexpr double next_to_it = 2e-9;

// A sensor faces along a surface when the cosine between its direction and the normal is larger.
constexpr double facing = 1e-2;

// A place, and a point so far before what it lies on that rays to behind it meet that.
struct PlaceAndPoint {
  SensorPlace place;
  Point before;
};

PlaceAndPoint place_of_sensor(const Sensor& sensor, std::span<const Facet> facets, double extent) {
  SensorPlace place{sensor};
  Point before = sensor.point;
  for (const Facet& facet : facets) {
    const double distance = std::max(share_of_polygon * facet.size, share_of_scene * extent);
    if (!lies_on(place.sensor.point, facet, distance)) continue;
    const double cosine = facet.normal.dot(sensor.normal);
    if (std::abs(cosine) < facing) {
      place.standing = Standing::undecided;
    } else {
      const double height = std::abs(cosine) > along_normal ? next_to_it * extent : distance;
      const Vector facing_normal = std::copysign(1.0, cosine) * facet.normal;
      const double lies_at = facing_normal.dot(place.sensor.point - facet.corners[0]);
      place.sensor.point += (height - lies_at) * facing_normal;
      before += (distance - facing_normal.dot(before - facet.corners[0])) * facing_normal;
    }
  }
  return {place, before};
}

}  // namespace

std::vector<SensorPlace> place_sensors(const Scene& scene, const KeptSides& sides, const Occluder& occluder) {
  const std::vector<Facet> facets = facets_of(scene);
  const std::vector<Sensor> sensors = all_sensors(scene.sensors);
  const double extent = extent_of(scene);
  std::vector<SensorPlace> places(sensors.size());
  std::vector<Point> points(sensors.size());
  parallel_for(sensors.size(), [&](std::size_t k) {
    const PlaceAndPoint found = place_of_sensor(sensors[k], facets, extent);
    places[k] = found.place;
    points[k] = found.before;
  });
  const std::vector<std::uint8_t> inside = inside_walls(scene, sides, occluder, facets, points);
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (inside[k]) places[k].standing = Standing::inside_wall;
  }
  return places;
}

}  // namespace patchlight
