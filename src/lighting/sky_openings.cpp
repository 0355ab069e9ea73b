#include "lighting/sky_openings.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/tolerances.h"
#include "scene/coverings.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t most_holes = 256;

double area_of(const std::array<Point, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  return (b - a).cross(c - a).norm() / 2;
}

// The triangles lie in one plane.
Opening opening_of(PolygonIndex polygon, const Vector& normal, std::vector<std::array<Point, 3>> triangles) {
  Opening opening{.polygon = polygon, .normal = normal, .centre = Point::Zero(), .triangles = std::move(triangles)};
  const Point& origin = opening.triangles[0][0];
  Vector moment = Vector::Zero();
  for (const auto& triangle : opening.triangles) {
    const double area = area_of(triangle);
    opening.area += area;
    opening.upto.push_back(opening.area);
    for (const Point& corner : triangle) moment += area / 3 * (corner - origin);
  }
  opening.centre = origin + moment / opening.area;
  for (const auto& triangle : opening.triangles)
    for (const Point& corner : triangle) opening.radius = std::max(opening.radius, (corner - opening.centre).norm());
  return opening;
}

// A hole, exactly in one plane.
Opening hole_of(const Hole& hole) {
  const Vector normal = area_vector(hole.pieces[0]).normalized();
  const Point on_plane = hole.pieces[0][0];
  std::vector<std::array<Point, 3>> triangles;
  for (std::vector<Point> piece : hole.pieces) {
    for (Point& corner : piece) corner -= normal.dot(corner - on_plane) * normal;
    for (const auto& triangle : triangles_of(piece)) triangles.push_back(triangle);
  }
  return opening_of(no_polygon, normal, std::move(triangles));
}

// The end of a straight line through a hole that has the sky at its other end, and the place where it meets a face.
struct LitEnd {
  Ray ray;  // from the hole towards that end
  std::optional<Hit> place;
};

std::vector<LitEnd> lit_ends(const Opening& hole, const LightPaths& paths) {
  static const auto samples = scrambled_sobol(64, 1);
  std::vector<Ray> ends;
  std::vector<Segment> ways;
  for (const auto& [u, v, s, t] : samples) {
    const Point on_hole = point_of(hole, u, v);
    const Vector direction = cosine_direction(hole.normal, s, t);
    for (const Vector& way : {direction, Vector(-direction)}) {
      ends.push_back({on_hole, way, no_polygon});
      ways.push_back({on_hole, paths.beyond(on_hole, way), no_polygon, no_polygon});
    }
  }
  const std::vector<std::uint8_t> blocked = paths.meets_opaque(ways);
  std::vector<Ray> lit;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (blocked[k] != 0 && blocked[k ^ 1U] == 0) lit.push_back(ends[k]);
  }
  const std::vector<std::optional<Hit>> places = paths.first_opaque_hits(lit);
  std::vector<LitEnd> found;
  for (std::size_t k = 0; k < lit.size(); ++k) found.push_back({lit[k], places[k]});
  return found;
}

// The share of their hemispheres in which nothing lies, weighted by the cosine.
double free_share(const Scene& scene, const std::vector<Hit>& places, const LightPaths& paths) {
  static const auto samples = scrambled_sobol(16, 1);
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

struct Candidate {
  PolygonIndex plane = 0;
  Opening opening;
  double light = 0;  // light_through()
};

std::vector<Candidate> largest_holes(const Scene& scene) {
  std::vector<Candidate> holes;
  for (const Hole& hole : holes_between_faces(scene)) holes.push_back({hole.plane, hole_of(hole)});
  std::stable_sort(holes.begin(), holes.end(),
                   [](const Candidate& a, const Candidate& b) { return a.opening.area > b.opening.area; });
  holes.resize(std::min<std::size_t>(holes.size(), 4096));
  return holes;
}

// The number of lines by which light gets in, times the area; 0 where the places that it meets see much of the sky.
double light_through(const Scene& scene, const Opening& hole, const LightPaths& paths) {
  std::vector<Hit> places;
  for (const LitEnd& end : lit_ends(hole, paths))
    if (end.place) places.push_back(*end.place);
  if (places.empty() || free_share(scene, places, paths) > much_sky) return 0;
  return hole.area * static_cast<double>(places.size());
}

// All holes of one plane as one.
std::vector<Candidate> joined_by_plane(const std::vector<Candidate>& holes) {
  std::map<PolygonIndex, Candidate> planes;
  for (const Candidate& hole : holes) {
    Candidate& all = planes.try_emplace(hole.plane, Candidate{hole.plane, hole.opening, 0}).first->second;
    if (all.light > 0) {
      std::vector<std::array<Point, 3>> triangles = all.opening.triangles;
      triangles.insert(triangles.end(), hole.opening.triangles.begin(), hole.opening.triangles.end());
      all.opening = opening_of(no_polygon, all.opening.normal, std::move(triangles));
    }
    all.light += hole.light;
  }
  std::vector<Candidate> joined;
  for (auto& [plane, all] : planes) joined.push_back(std::move(all));
  return joined;
}

std::vector<Opening> shining_holes(const Scene& scene, const LightPaths& paths) {
  std::vector<Candidate> holes = largest_holes(scene);
  parallel_for(holes.size(), [&](std::size_t k) { holes[k].light = light_through(scene, holes[k].opening, paths); });
  std::erase_if(holes, [](const Candidate& hole) { return !(hole.light > 0); });
  if (holes.size() > most_holes) holes = joined_by_plane(holes);
  std::stable_sort(holes.begin(), holes.end(),
                   [](const Candidate& a, const Candidate& b) { return a.light > b.light; });
  if (holes.size() > most_holes) holes.resize(most_holes);
  std::vector<Opening> openings;
  for (Candidate& hole : holes) openings.push_back(std::move(hole.opening));
  return openings;
}

// The share of the lit lines through a hole that passes none of these openings.
double share_apart(const Opening& hole, const LightPaths& paths, const std::vector<Opening>& openings) {
  const std::vector<LitEnd> ends = lit_ends(hole, paths);
  double apart = 0;
  for (const auto& [ray, place] : ends) {
    if (!place) continue;
    const auto is_on_way = [&, from = place->point, to_sky = Vector(-ray.direction)](const Opening& opening) {
      return distance_to(opening, from, to_sky).has_value();
    };
    if (std::none_of(openings.begin(), openings.end(), is_on_way)) apart += 1 / static_cast<double>(ends.size());
  }
  return apart;
}

}  // namespace

Point point_of(const Opening& opening, double u, double v) {
  const double wanted = u * opening.area;
  const auto found = std::upper_bound(opening.upto.begin(), opening.upto.end(), wanted);
  const std::size_t k = std::min<std::size_t>(found - opening.upto.begin(), opening.upto.size() - 1);
  const double before = k == 0 ? 0 : opening.upto[k - 1];
  const auto& [a, b, c] = opening.triangles[k];
  const Eigen::Vector2d weights =
      square_to_triangle(std::clamp((wanted - before) / (opening.upto[k] - before), 0.0, 1.0), v);
  return a + weights[0] * (b - a) + weights[1] * (c - a);
}

std::optional<double> distance_to(const Opening& opening, const Point& origin, const Vector& direction) {
  const double facing = opening.normal.dot(direction);
  if (facing == 0) return std::nullopt;
  const double distance = opening.normal.dot(opening.centre - origin) / facing;
  if (!(distance > 0)) return std::nullopt;
  const Point met = origin + distance * direction;
  if ((met - opening.centre).squaredNorm() > (1 + tolerance_of_shapes) * opening.radius * opening.radius)
    return std::nullopt;
  const auto holds = [&](const std::array<Point, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    return turn(opening.normal, a, b, met) >= 0 && turn(opening.normal, b, c, met) >= 0 &&
           turn(opening.normal, c, a, met) >= 0;
  };
  if (std::none_of(opening.triangles.begin(), opening.triangles.end(), holds)) return std::nullopt;
  return distance;
}

double density_at(const Opening& opening, double probability, double distance, const Vector& direction) {
  const double facing = std::abs(opening.normal.dot(direction));
  return facing > 0 ? probability * distance * distance / (facing * opening.area) : 0;
}

double apparent_size(const Opening& opening, const Point& from) {
  return opening.area / ((opening.centre - from).squaredNorm() + opening.area);
}

// Mostly the center decides.
bool rises_above(const Opening& opening, const Point& on_plane, const Vector& normal, double height) {
  const double middle = normal.dot(opening.centre - on_plane) - height;
  if (std::abs(middle) > (1 + tolerance_of_shapes) * opening.radius) return middle > 0;
  for (const auto& triangle : opening.triangles)
    for (const Point& corner : triangle)
      if (normal.dot(corner - on_plane) > height) return true;
  return false;
}

Opening opening_at(const Scene& scene, PolygonIndex polygon) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  return opening_of(polygon, area_vector(corners).normalized(), triangles_of(corners));
}

std::vector<Opening> sky_openings(const Scene& scene, const LightPaths& paths) {
  std::vector<Opening> openings;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_opening(scene, p)) openings.push_back(opening_at(scene, p));
  }
  for (Opening& hole : shining_holes(scene, paths)) {
    // A hole adds little if 95 % of its lit lines pass other openings.
    if (share_apart(hole, paths, openings) > 0.05) openings.push_back(std::move(hole));
  }
  return openings;
}

std::size_t first_hole(const std::vector<Opening>& openings) {
  const auto is_face = [](const Opening& opening) { return opening.polygon != no_polygon; };
  return static_cast<std::size_t>(std::partition_point(openings.begin(), openings.end(), is_face) - openings.begin());
}

std::optional<std::size_t> opening_of(const std::vector<Opening>& openings, PolygonIndex polygon) {
  const auto end = openings.begin() + static_cast<std::ptrdiff_t>(first_hole(openings));
  const auto found = std::lower_bound(openings.begin(), end, polygon,
                                      [](const Opening& opening, PolygonIndex p) { return opening.polygon < p; });
  if (found == end || found->polygon != polygon) return std::nullopt;
  return static_cast<std::size_t>(found - openings.begin());
}

}  // namespace patchlight
