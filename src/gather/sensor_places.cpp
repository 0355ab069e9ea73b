#include "gather/sensor_places.h"

#include "patchlight/scene/sides.h"

#include "base/parallel.h"
#include "gather/facets.h"
#include "scene/extent.h"
#include "scene/shells.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr std::size_t directions_around = 64;

// A rim lies on a polygon that is no farther away than this share of the scene's extent.
constexpr double rim_tolerance = 1e-6;

// Places met are looked at from short of them by this share of the way.
constexpr double short_of = 0.01;

// Directions spread over the sphere: a spiral with the golden angle between one and the next.
std::vector<Vector> directions() {
  std::vector<Vector> all;
  for (std::size_t k = 0; k < directions_around; ++k) {
    const double z = 1 - (2.0 * static_cast<double>(k) + 1) / directions_around;
    const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(k);
    const double radius = std::sqrt(1 - z * z);
    all.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return all;
}

using Hits = std::vector<Hit>;

// The hits in all directions; nothing if a ray leaves the scene.
Hits hits_around(const Point& point, const Occluder& occluder) {
  static const std::vector<Vector> around = directions();
  std::vector<Ray> all;
  for (const Vector& direction : around) all.push_back({point, direction});
  Hits hits;
  for (const std::optional<Hit>& hit : occluder.first_hits(all)) {
    if (!hit) return {};
    hits.push_back(*hit);
  }
  return hits;
}

// Sides that take part, by both ways to choose them.
struct TakingPart {
  const KeptSides& chosen;
  KeptSides automatic;

  bool operator()(PolygonIndex polygon, Side side) const {
    const auto kept = [&](const KeptSides& sides) { return (side == Side::front ? sides.front : sides.back)[polygon]; };
    return kept(chosen) != 0 && kept(automatic) != 0;
  }
};

// A shell as a wall that stands on other polygons.
struct StandingWall {
  bool stands = false;           // its rim lies on them everywhere
  std::set<PolygonIndex> bases;  // these
};

struct Walls {
  const Scene& scene;
  const Occluder& occluder;
  std::span<const Facet> facets;
  TakingPart takes_part;
  Shells shells;
  std::vector<std::uint32_t> place;  // per vertex: the first one that is welded with it
  double tolerance = 0;              // metres
  std::vector<Point> lamps;          // a point on each

  bool is_seen_from_behind(const Hit& hit) const {
    return (hit.side == Side::back) != (shells.turned[hit.polygon] != 0);
  }
  std::optional<PolygonIndex> open_shell(const Hits& hits) const;
  StandingWall standing_wall(PolygonIndex shell) const;
  bool is_inside(const Point& point, const Hits& hits, PolygonIndex shell, const StandingWall& wall) const;
  bool sees_lamp(const Point& point, const Hits& hits) const;
};

// The shell whose polygons are met from behind by half of the rays or more, if it is open.
std::optional<PolygonIndex> Walls::open_shell(const Hits& hits) const {
  std::map<PolygonIndex, std::size_t> counts;
  for (const Hit& hit : hits) {
    if (!shells.closed[hit.polygon] && is_seen_from_behind(hit)) ++counts[shells.shell[hit.polygon]];
  }
  for (const auto& [shell, count] : counts) {
    if (2 * count >= hits.size()) return shell;
  }
  return {};
}

// Both ends and the middle of every edge that only one of its polygons has must lie on others.
StandingWall Walls::standing_wall(PolygonIndex shell) const {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (shells.shell[p] != shell) continue;
    if (is_opening(scene, p)) return {};
    const auto& corners = scene.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto edge = std::minmax(place[corners[k]], place[corners[(k + 1) % corners.size()]]);
      ++uses[{edge.first, edge.second}];
    }
  }
  StandingWall wall{true, {}};
  for (const auto& [edge, count] : uses) {
    if (count > 1) continue;
    const Point& a = scene.vertices[edge.first];
    const Point& b = scene.vertices[edge.second];
    for (const Point& point : {a, Point((a + b) / 2), b}) {
      bool covered = false;
      for (PolygonIndex p = 0; p < facets.size(); ++p) {
        if (shells.shell[p] == shell || !lies_on(point, facets[p], tolerance)) continue;
        covered = true;
        wall.bases.insert(p);
      }
      if (!covered) return {};
    }
  }
  return wall;
}

bool Walls::sees_lamp(const Point& point, const Hits& hits) const {
  std::vector<Segment> segments;
  for (const Point& lamp : lamps) {
    segments.push_back({point, lamp});
    for (const Hit& hit : hits) segments.push_back({hit.point + short_of * (point - hit.point), lamp});
  }
  const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
  return std::find(blocked.begin(), blocked.end(), 0) != blocked.end();
}

bool Walls::is_inside(const Point& point, const Hits& hits, PolygonIndex shell, const StandingWall& wall) const {
  if (!wall.stands) return false;
  return std::all_of(hits.begin(), hits.end(),
                     [&](const Hit& hit) {
                       if (!takes_part(hit.polygon, hit.side)) return true;
                       if (emits(scene, hit.polygon, hit.side) || is_opening(scene, hit.polygon)) return false;
                       if (shells.shell[hit.polygon] == shell) return is_seen_from_behind(hit);
                       return wall.bases.count(hit.polygon) > 0;
                     }) &&
         !sees_lamp(point, hits);
}

std::vector<Point> points_on_lamps(const Scene& scene, std::span<const Facet> facets) {
  std::vector<Point> lamps;
  for (PolygonIndex p = 0; p < facets.size(); ++p) {
    if (is_lamp(scene, p)) lamps.push_back(area_centroid(facets[p].corners));
  }
  for (const Luminaire& luminaire : scene.luminaires) lamps.push_back(luminaire.position);
  return lamps;
}

// Per point 1 when it is inside a wall, as place_sensors() has it.
std::vector<std::uint8_t> inside_walls(const Scene& scene, const KeptSides& sides, const Occluder& occluder,
                                       std::span<const Facet> facets, std::span<const Point> points) {
  const Walls walls{scene,
                    occluder,
                    facets,
                    {sides, kept_sides(scene, Sides::automatic)},
                    shells_of(scene),
                    welded(scene.vertices, weld_distance(scene)),
                    rim_tolerance * extent_of(scene),
                    points_on_lamps(scene, facets)};

  // 1. What each point has around it: sides that take no part, or a shell that may be a wall
  std::vector<std::uint8_t> inside(points.size(), 0);
  std::vector<std::optional<PolygonIndex>> shell(points.size());
  parallel_for(points.size(), [&](std::size_t k) {
    const Hits hits = hits_around(points[k], occluder);
    inside[k] = !hits.empty() && std::none_of(hits.begin(), hits.end(),
                                              [&](const Hit& hit) { return walls.takes_part(hit.polygon, hit.side); });
    if (!inside[k]) shell[k] = walls.open_shell(hits);
  });

  // 2. Those shells
  std::map<PolygonIndex, StandingWall> standing;
  for (const std::optional<PolygonIndex>& one : shell) {
    if (one && standing.count(*one) == 0) standing[*one] = walls.standing_wall(*one);
  }
  parallel_for(points.size(), [&](std::size_t k) {
    if (shell[k])
      inside[k] = walls.is_inside(points[k], hits_around(points[k], occluder), *shell[k], standing.at(*shell[k]));
  });
  return inside;
}

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

std::vector<SensorPlace> place_sensors(const Scene& scene, const std::vector<SensorGroup>& groups,
                                       const KeptSides& sides, const Occluder& occluder) {
  const std::vector<Facet> facets = facets_of(scene);
  const std::vector<Sensor> sensors = all_sensors(groups);
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
