#include "lighting/sky_openings.h"

#include "base/sampling.h"
#include "scene/holes.h"
#include "scene/triangulate.h"
#include "scene/turn.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

namespace patchlight {
namespace {

// Lines through a hole, and rays from a place at which one of them ends, to find out how much sky that sees.
constexpr std::uint32_t lines_through_a_hole = 64;
constexpr std::uint32_t rays_from_a_place = 16;

constexpr std::size_t most_holes = 64;
constexpr std::size_t most_candidates = 4096;  // the largest are looked at
constexpr std::uint32_t seed_of_lines = 1;

Opening opening_of(PolygonIndex polygon, const std::vector<Point>& corners) {
  const Vector area = area_vector(corners);
  return {polygon, area.normalized(), area_centroid(corners), area.norm(), triangles_of(corners)};
}

// The end of a straight line through a hole that has the sky at its other end.
struct LitEnd {
  Point on_hole;
  Vector direction;  // towards that end
};

std::vector<LitEnd> lit_ends(const Opening& hole, const LightPaths& paths) {
  static const auto samples = scrambled_sobol(lines_through_a_hole, seed_of_lines);
  std::vector<LitEnd> ends;
  std::vector<Segment> ways;
  for (const auto& [u, v, s, t] : samples) {
    const Point on_hole = point_of(hole, u, v);
    const Vector direction = cosine_direction(hole.normal, s, t);
    for (const Vector& way : {direction, Vector(-direction)}) {
      ends.push_back({on_hole, way});
      ways.push_back({on_hole, paths.beyond(on_hole, way), no_polygon, no_polygon});
    }
  }
  const std::vector<std::uint8_t> blocked = paths.meets_opaque(ways);
  std::vector<LitEnd> lit;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (blocked[k] != 0 && blocked[k ^ 1U] == 0) lit.push_back(ends[k]);
  }
  return lit;
}

// The places where they meet faces.
std::vector<Hit> places_behind(const std::vector<LitEnd>& ends, const LightPaths& paths) {
  std::vector<Ray> rays;
  for (const LitEnd& end : ends) rays.push_back({end.on_hole, end.direction, no_polygon});
  std::vector<Hit> places;
  for (const std::optional<Hit>& hit : paths.first_opaque_hits(rays)) {
    if (hit) places.push_back(*hit);
  }
  return places;
}

// The share of their hemispheres in which nothing lies, weighted by the cosine.
double free_share(const Scene& scene, const std::vector<Hit>& places, const LightPaths& paths) {
  static const auto samples = scrambled_sobol(rays_from_a_place, seed_of_lines);
  std::vector<Segment> rays;
  for (const Hit& place : places) {
    const Vector normal = (place.side == Side::front ? 1 : -1) * front_normal(scene, place.polygon);
    for (const auto& [u, v, s, t] : samples)
      rays.push_back(
          {place.point, paths.beyond(place.point, cosine_direction(normal, s, t)), place.polygon, no_polygon});
  }
  const std::vector<std::uint8_t> blocked = paths.meets_opaque(rays);
  return static_cast<double>(std::count(blocked.begin(), blocked.end(), 0)) / static_cast<double>(blocked.size());
}

std::vector<Opening> largest_holes(const Scene& scene) {
  std::vector<Opening> holes;
  for (const std::vector<Point>& outline : holes_between_faces(scene)) holes.push_back(opening_of(no_polygon, outline));
  std::stable_sort(holes.begin(), holes.end(), [](const Opening& a, const Opening& b) { return a.area > b.area; });
  if (holes.size() > most_candidates) holes.resize(most_candidates);
  return holes;
}

std::vector<Opening> shining_holes(const Scene& scene, const LightPaths& paths) {
  struct Candidate {
    Opening hole;
    double lines;  // that get in, by its area
  };
  std::vector<Candidate> found;
  for (Opening& hole : largest_holes(scene)) {
    const std::vector<Hit> places = places_behind(lit_ends(hole, paths), paths);
    if (places.empty() || free_share(scene, places, paths) > much_sky) continue;
    const double lines = hole.area * static_cast<double>(places.size());
    found.push_back({std::move(hole), lines});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.lines > b.lines; });
  std::vector<Opening> holes;
  for (Candidate& candidate : std::span(found).first(std::min(found.size(), most_holes)))
    holes.push_back(std::move(candidate.hole));
  return holes;
}

}  // namespace

Point point_of(const Opening& opening, double u, double v) {
  std::vector<double> shares;
  for (const auto& [a, b, c] : opening.triangles) shares.push_back((b - a).cross(c - a).norm() / 2 / opening.area);
  const Choice triangle = choose(shares, u);
  const auto& [a, b, c] = opening.triangles[triangle.index];
  const Eigen::Vector2d weights = square_to_triangle(triangle.rest, v);
  return a + weights[0] * (b - a) + weights[1] * (c - a);
}

std::optional<double> distance_to(const Opening& opening, const Point& origin, const Vector& direction) {
  const double facing = opening.normal.dot(direction);
  if (facing == 0) return std::nullopt;
  const double distance = opening.normal.dot(opening.centre - origin) / facing;
  if (!(distance > 0)) return std::nullopt;
  const Point met = origin + distance * direction;
  const auto holds = [&](const std::array<Point, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    return turn(opening.normal, a, b, met) >= 0 && turn(opening.normal, b, c, met) >= 0 &&
           turn(opening.normal, c, a, met) >= 0;
  };
  if (std::none_of(opening.triangles.begin(), opening.triangles.end(), holds)) return std::nullopt;
  return distance;
}

std::vector<Opening> sky_openings(const Scene& scene, const LightPaths& paths) {
  std::vector<Opening> openings = shining_holes(scene, paths);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_opening(scene, p)) openings.push_back(opening_of(p, corner_points(scene, p)));
  }
  return openings;
}

}  // namespace patchlight
