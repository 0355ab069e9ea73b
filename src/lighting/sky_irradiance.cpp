#include "lighting/sky_irradiance.h"

#include "base/sampling.h"
#include "base/tolerances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

Vector toward(const Opening& opening, const Point& from, double u, double v) {
  return (point_of(opening, u, v) - from).normalized();
}

// The share of a few rays in some directions that meet nothing opaque. They decide whether aiming pays, with places and
// directions of their own, so that the aim does not depend on the light that is found.
template <class Direction>
double free_share_ahead(const Lighting& lighting, const Receiver& receiver, const Direction& direction_at) {
  static const auto samples = scrambled_sobol(32, 2);
  std::vector<Segment> rays;
  for (const auto& [u, v, s, t] : samples) {
    const SurfacePoint at = receiver.place(u, v);
    rays.push_back({at.point, lighting.paths.beyond(at.point, direction_at(at, s, t)), at.polygon, no_polygon});
  }
  const std::vector<std::uint8_t> blocked = lighting.paths.meets_opaque(rays);
  return static_cast<double>(std::count(blocked.begin(), blocked.end(), 0)) / static_cast<double>(blocked.size());
}

// Does a ray to the sky through one of the holes get there?
bool sees_sky_through_holes(const Lighting& lighting, const Receiver& receiver, const Chooser& openings) {
  return free_share_ahead(lighting, receiver, [&](const SurfacePoint& at, double s, double t) {
           const Choice opening = openings.at(s);
           return toward(lighting.openings[opening.index], at.point, opening.rest, t);
         }) > 0;
}

bool sees_much_sky(const Lighting& lighting, const Receiver& receiver) {
  return free_share_ahead(lighting, receiver, [](const SurfacePoint& at, double s, double t) {
           return cosine_direction(at.normal, s, t);
         }) > much_sky;
}

// How far along a ray from here that crosses these clear faces, and meets nothing opaque, an opening lies; nothing when
// it is not met.
std::optional<double> distance_to(const Opening& opening, const Point& from, const Vector& direction,
                                  const std::vector<Crossing>& crossings) {
  if (opening.polygon == no_polygon) return distance_to(opening, from, direction);
  const auto crossing =
      std::find_if(crossings.begin(), crossings.end(), [&](const Crossing& c) { return c.polygon == opening.polygon; });
  if (crossing == crossings.end()) return std::nullopt;
  return crossing->distance;
}

// Density of the rays towards openings, 1/sr, for such a ray. Without probabilities there are none.
double aimed_density(const Lighting& lighting, const Chooser& aimed, const Point& from, const Vector& direction,
                     const std::vector<Crossing>& crossings) {
  double density = 0;
  if (aimed.empty()) return density;
  const std::vector<Opening>& openings = lighting.openings;
  for (const Alternative& hole : aimed.alternatives_from(first_hole(openings))) {
    if (const auto distance = distance_to(openings[hole.index], from, direction))
      density += density_at(openings[hole.index], hole.probability, *distance, direction);
  }
  for (const Crossing& crossing : crossings) {
    if (const auto k = opening_of(openings, crossing.polygon))
      density += density_at(openings[*k], aimed.probability_of(*k), crossing.distance, direction);
  }
  return density;
}

// A ray of a set of samples.
struct SkyRay {
  std::size_t set = 0;
  Vector direction;
  double cosine = 0;                    // to the receiver's normal
  std::optional<std::size_t> aimed_at;  // an opening; nothing: over the hemisphere
};

// The numbers of places of a set that send rays.
struct SkyPlaces {
  std::size_t all = 0;
  std::size_t scattered = 0;  // with a ray over the hemisphere
  std::size_t aimed = 0;      // with a ray to an opening
};

struct SkyRays {
  std::vector<SkyRay> rays;
  std::vector<Segment> segments;
  std::vector<SkyPlaces> places;  // per set

  void add_set(const Lighting& lighting, const Receiver& receiver, SamplePoints samples, const SkyAim& aim);
};

// Where there are panes, nearly all light comes through them. Half of the places send a ray to a pane. A quarter of
// these also send one over the hemisphere. Rays to holes, which may be hidden from the receiver, are a third of all.
void SkyRays::add_set(const Lighting& lighting, const Receiver& receiver, SamplePoints samples, const SkyAim& aim) {
  const auto add = [&, set = places.size()](const SurfacePoint& at, const Vector& direction,
                                            std::optional<std::size_t> aimed_at) {
    const double cosine = at.normal.dot(direction);
    if (!(cosine > 0)) return;
    rays.push_back({set, direction, cosine, aimed_at});
    segments.push_back({at.point, lighting.paths.beyond(at.point, direction), at.polygon, no_polygon});
  };
  // The first half or eighth of a Sobol sequence is spread as evenly as all of it.
  const std::size_t half = (samples.size() + 1) / 2;
  if (aim.at_panes) samples = samples.first(half);
  const std::size_t scattered = aim.at_panes ? (half + 3) / 4 : samples.size();
  SkyPlaces of_set;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto& [u, v, s, t] = samples[k];
    const SurfacePoint at = receiver.place(u, v);
    if (is_covered(lighting, receiver, at)) continue;
    ++of_set.all;
    if (k < scattered) {
      ++of_set.scattered;
      add(at, cosine_direction(at.normal, s, t), std::nullopt);
    }
    if (aim.openings.empty() || k >= half) continue;
    ++of_set.aimed;
    const Choice chosen = aim.openings.at(s);
    add(at, toward(lighting.openings[chosen.index], at.point, chosen.rest, t), chosen.index);
  }
  places.push_back(of_set);
}

// L tau cos cos' towards the middle or a corner of an opening, the largest of each band: where its middle is below the
// horizon of the place, a corner may be above.
Spectrum brightest_of(const Lighting& lighting, const SurfacePoint& at, const Opening& opening) {
  std::vector<Point> points{opening.centre};
  for (const auto& triangle : opening.triangles) points.insert(points.end(), triangle.begin(), triangle.end());
  std::vector<Segment> across;
  std::vector<double> cosines;
  for (const Point& point : points) {
    const Vector direction = (point - at.point).normalized();
    const Vector half_way = 1e-3 * opening.radius * direction;  // across the opening, to find its transmittance
    cosines.push_back(std::max(0.0, at.normal.dot(direction)) * std::abs(opening.normal.dot(direction)));
    across.push_back({opening.centre - half_way, opening.centre + half_way, no_polygon, no_polygon});
  }
  const std::vector<Passage> passages = lighting.paths.passages(across);
  Spectrum most = Spectrum::Zero(lighting.bands);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Spectrum sky = radiance(*lighting.sky, (points[k] - at.point).normalized());
    if (passages[k].transmittance.size() > 0) most = most.max(cosines[k] * passages[k].transmittance * sky);
  }
  return most;
}

std::vector<Point> corners_of(const Opening& opening) {
  std::vector<Point> corners;
  for (const auto& triangle : opening.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

}  // namespace

SkyAim sky_aim(const Lighting& lighting, const Receiver& receiver, AimFor what) {
  const SurfacePoint at = receiver.place(0.5, 0.5);
  std::vector<double> probabilities;
  bool at_panes = false;
  double sum = 0;
  for (const Opening& opening : lighting.openings) {
    const double square = (opening.centre - at.point).squaredNorm();
    const bool is_own = opening.polygon != no_polygon && opening.polygon == at.polygon;
    const bool is_before = rises_above(opening, at.point, at.normal, tolerance_of_shapes * std::sqrt(square));
    // At a point rays that a single wall blocks would count as light that they may have missed. It has to block them
    // from all of a patch whose points share the aim.
    const std::span<const Point> places = receiver.is_point() ? std::span(&at.point, 1) : std::span(receiver.corners);
    const bool is_hidden =
        what == AimFor::points && is_before && !is_own && lighting.paths.hides(places, corners_of(opening));
    const double weight = is_before && !is_own && !is_hidden ? apparent_size(opening, at.point) : 0;
    probabilities.push_back(weight);
    at_panes = at_panes || (weight > 0 && opening.polygon != no_polygon);
    sum += weight;
  }
  if (!(sum > 0)) return {};
  const auto count = static_cast<double>(
      std::count_if(probabilities.begin(), probabilities.end(), [](double weight) { return weight > 0; }));
  constexpr double any_alike = 0.125;
  for (double& probability : probabilities)
    probability = probability > 0 ? (1 - any_alike) * probability / sum + any_alike / count : 0;
  const SkyAim aim{Chooser(probabilities), at_panes};
  if (!at_panes && what == AimFor::patch && !sees_sky_through_holes(lighting, receiver, aim.openings)) return {};
  return sees_much_sky(lighting, receiver) ? SkyAim() : aim;
}

SkyLight sky_irradiance(const Lighting& lighting, const Receiver& receiver, const SkyAim& aim,
                        std::span<const SamplePoints> sets) {
  Field irradiance = Field::Zero(static_cast<Eigen::Index>(sets.size()), lighting.bands);
  SkySeen seen =
      visit_sky(lighting, receiver, aim, sets, [&](std::size_t set, const Vector& direction, const Spectrum& weight) {
        irradiance.row(static_cast<Eigen::Index>(set)) += weight * radiance(*lighting.sky, direction);
      });
  return {std::move(irradiance), std::move(seen)};
}

SkySeen visit_sky(const Lighting& lighting, const Receiver& receiver, const SkyAim& aim,
                  std::span<const SamplePoints> sets, const AtSky& at_sky) {
  SkyRays all;
  for (const SamplePoints samples : sets) all.add_set(lighting, receiver, samples, aim);
  SkySeen seen{std::vector<std::uint8_t>(aim.openings.empty() ? 0 : lighting.openings.size(), 0), 0};
  for (const SkyPlaces& places : all.places) seen.aimed += places.aimed;
  // Each ray counts L cos tau over the density of rays of both kinds in its direction.
  const std::vector<Passage> passages = lighting.paths.passages(all.segments);
  for (std::size_t k = 0; k < passages.size(); ++k) {
    const auto& [transmittance, crossings] = passages[k];
    if (!(transmittance > 0).any()) continue;
    const auto& [set, direction, cosine, aimed_at] = all.rays[k];
    const Point& from = all.segments[k].from;
    // A ray that slips past the edge of its opening belongs to neither kind.
    const bool is_aimed = aimed_at.has_value();
    if (is_aimed && !distance_to(lighting.openings[*aimed_at], from, direction, crossings)) continue;
    if (is_aimed) seen.through[*aimed_at] = 1;
    const SkyPlaces& places = all.places[set];
    const auto number = static_cast<double>(places.all);
    const double over_hemisphere = static_cast<double>(places.scattered) / number * cosine / std::numbers::pi;
    const double at_openings =
        static_cast<double>(places.aimed) / number * aimed_density(lighting, aim.openings, from, direction, crossings);
    // Rays over the hemisphere that are so rare hardly ever get there, and their absence would not be noticed.
    const bool is_cut_off = at_openings > 8 * over_hemisphere;
    if (is_cut_off && !is_aimed) continue;
    const double density = is_cut_off ? at_openings : over_hemisphere + at_openings;
    at_sky(set, direction, transmittance * (cosine / (density * number)));
  }
  return seen;
}

Spectrum missed_sky(const Lighting& lighting, const SurfacePoint& at, const SkyAim& aim, const SkySeen& seen) {
  Spectrum most = Spectrum::Zero(lighting.bands);
  for (const auto& [k, probability, up_to] : aim.openings.alternatives()) {
    if (seen.through[k] != 0) continue;
    const double rays = static_cast<double>(seen.aimed) * probability;
    const double size = apparent_size(lighting.openings[k], at.point);
    most = most.max(brightest_of(lighting, at, lighting.openings[k]) * size / rays);
  }
  return most;
}

}  // namespace patchlight
