#include "gather/sensor_places.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "scene/extent.h"
#include "scene/solids.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// A polygon to compare points with.
struct Facet {
  std::vector<Point> corners;
  Vector normal;    // unit, of its front
  double size = 0;  // meters, the diagonal of its bounds

  // Meters before its front.
  double height(const Point& point) const { return normal.dot(point - corners[0]); }
};

std::vector<Facet> facets_of(const Scene& scene) {
  std::vector<Facet> facets;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    Facet facet{corner_points(scene, p), front_normal(scene, p)};
    Box box;
    for (const Point& corner : facet.corners) box.extend(corner);
    facet.size = box.diagonal().norm();
    facets.push_back(std::move(facet));
  }
  return facets;
}

double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - along * (b - a)).norm();
}

// Winding number of the facet around the point by the angles under which its edges are seen; seams cancel.
bool is_over(const Point& point, const Facet& facet) {
  double angle = 0;
  for (std::size_t k = 0; k < facet.corners.size(); ++k) {
    const Vector a = facet.corners[k] - point;
    const Vector b = facet.corners[(k + 1) % facet.corners.size()] - point;
    angle += std::atan2(a.cross(b).dot(facet.normal), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

// True when the point is no farther than `tolerance`, in meters, from the polygon.
bool lies_on(const Point& point, const Facet& facet, double tolerance) {
  if (std::abs(facet.height(point)) > tolerance) return false;
  if (is_over(point, facet)) return true;
  for (std::size_t k = 0; k < facet.corners.size(); ++k) {
    const Point& next = facet.corners[(k + 1) % facet.corners.size()];
    if (distance_to_segment(point, facet.corners[k], next) <= tolerance) return true;
  }
  return false;
}

constexpr std::size_t directions_around = 64;

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

// Sides that are simulated, by both ways to choose them.
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
  const Shells& shells;
  std::vector<std::uint32_t> place;  // per vertex: the first one that is welded with it
  double tolerance = 0;              // meters
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
    for (const Hit& hit : hits) segments.push_back({hit.point + 0.01 * (point - hit.point), lamp});  // short of it
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

std::vector<Point> points_on_emitters(const Scene& scene, std::span<const Facet> facets) {
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
  const std::shared_ptr<const SceneGeometry> geometry = geometry_of(scene, sides);
  const Walls walls{scene,
                    occluder,
                    facets,
                    {sides, kept_sides(scene, Sides::automatic, {}, geometry)},
                    geometry->shells,
                    welded(scene.vertices, weld_distance(scene)),
                    tolerance_of_coordinates * extent_of(scene),
                    points_on_emitters(scene, facets)};

  // 1. The surroundings of each point: sides that are not simulated, or a shell that may be a wall
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

// A place, and a point so far before its polygon that rays to places behind the polygon meet it.
struct PlaceAndPoint {
  SensorPlace place;
  Point before;
};

// A sensor lies on a polygon when it is nearer to it than 1e-5 of the polygon's size: coordinates are often written
// with five or six digits. Ten times the resolution of shadow rays is near enough, too. If it faces along the normal,
// it sends no ray to where the polygon hides something. Then it is read just far enough from the polygon for the
// occluder to know on which side.
PlaceAndPoint place_of_sensor(const Sensor& sensor, std::span<const Facet> facets, double extent) {
  SensorPlace place{sensor};
  Point before = sensor.point;
  for (const Facet& facet : facets) {
    const double distance = std::max(1e-5 * facet.size, tolerance_of_coordinates * extent);
    if (!lies_on(place.sensor.point, facet, distance)) continue;
    const double cosine = facet.normal.dot(sensor.normal);
    if (std::abs(cosine) < 0.01) {  // within 0.6 degrees of the plane
      place.standing = Standing::undecided;
    } else {
      const double height =
          std::abs(cosine) > 1 - tolerance_of_coordinates ? 2 * tolerance_of_shapes * extent : distance;
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
