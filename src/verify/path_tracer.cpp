#include "verify/path_tracer.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "scene/coverings.h"
#include "verify/exposed.h"
#include "verify/lamps.h"
#include "verify/lights.h"
#include "verify/ray_end.h"
#include "verify/sensor_point.h"
#include "verify/surfaces.h"
#include "visibility/occluder.h"
#include "visibility/tracing.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

// Radiosity B and irradiance H of a diffuse scene obey, at every point x (Kajiya 1986),
//
//   H(x) = int L(x, w) cos(theta) dw,    L(x, w) = B(y) / pi,    B(y) = E(y) + rho(y) H(y),
//
// y the point that x sees in the direction w. Directions are distributed as cos(theta) / pi, so that one of them
// estimates H(x) by B(y); rho(y) H(y) is found in the same way, and so on: a path. It goes on with a probability, and
// what goes on is divided by it, which keeps the mean (Russian roulette, Arvo and Kirk 1990).
//
// The E(y) of lamps is also found by points on them and shadow rays, as a path seldom meets a small lamp. Where both
// can find the same light, each of them counts it with its density over the sum of both (balance heuristic, Veach and
// Guibas 1995): together once. By points on lamps alone, the variance would be infinite beside a lamp.
//
// Luminaires without extent, spheres and the sun meet no scattered ray: shadow rays alone find them. The sky is found
// by scattered rays alone, those that leave the scene, through clear openings or where nothing is.
//
// A sheet has B(y) = E(y) + rho(y) H(y) + tau(y) H(y, other side): a path that meets it goes on from either side.
//
// A ray that meets a mirror or a clear face goes on through it, or as from a mirror, or ends there, by chance. Lamps
// behind mirrors are found by such rays alone; luminaires and sun by shadow rays over each chain of mirrors.

namespace patchlight {
namespace {

// A path may go on for ever between surfaces that absorb nothing.
constexpr double highest_survival = 0.9999;

// After so many bounces luminaires and sun are looked for at one vertex of so many, whose light counts as that of all:
// between white faces paths take thousands, and each would ask every chain of mirrors.
constexpr std::uint64_t many_bounces = 32;
constexpr double asked_of_many = 1.0 / 16;

// A place where light arrives on its way to the receiver.
struct Vertex {
  Point point;
  Vector normal;                      // unit, out of the side that receives
  PolygonIndex polygon = no_polygon;  // no_polygon: a sensor
  Side side = Side::front;
  std::uint32_t path = 0;
  Spectrum throughput;  // share of the irradiance here that gets to the receiver
};

// A path, and the seed of its numbers at this length.
struct PathSeed {
  std::uint32_t path = 0;
  std::uint64_t seed = 0;
};

// What a batch of paths has found, or a step of it.
struct Batch {
  Spectrum irradiance;  // sum over paths, W/m^2
  std::uint32_t exposed = 0;
  std::uint64_t rays = 0;
};

// The next vertices of paths, and the light met on the way.
struct Step {
  std::vector<Vertex> vertices;
  Spectrum irradiance;
};

using Samples = std::vector<std::array<double, 4>>;

// A stratified sample for each path. Samples of different seeds are in unrelated orders, or the same path would get the
// same strata each time (Burley 2020, section 5). `count` is a power of two.
Samples shuffled_samples(std::uint32_t count, std::uint32_t seed) {
  Samples ordered = scrambled_sobol(count, seed);
  if (count == 1) return ordered;
  const int unused = std::countl_zero(count - 1);
  Samples shuffled(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    shuffled[k] = ordered[owen_scramble(k << unused, hash({seed, 4})) >> unused];
  }
  return shuffled;
}

// One for each vertex. Where few of the paths are left, strata say nothing any more: their numbers are independent, and
// cost no more than these paths do, however long some are.
Samples samples_at(const std::vector<Vertex>& vertices, std::uint32_t paths, std::uint32_t seed) {
  constexpr std::size_t few = 8;  // one in so many
  Samples samples(vertices.size());
  if (few * vertices.size() < paths) {
    for (std::size_t k = 0; k < vertices.size(); ++k)
      for (std::size_t d = 0; d < 4; ++d) samples[k][d] = uniform({seed, vertices[k].path, 6 + d});
    return samples;
  }
  const Samples of_paths = shuffled_samples(paths, seed);
  for (std::size_t k = 0; k < vertices.size(); ++k) samples[k] = of_paths[vertices[k].path];
  return samples;
}

struct PathTracer {
  std::shared_ptr<const Tracing> tracing;
  const Occluder& occluder;
  Surfaces surfaces;
  Lamps lamps;
  std::optional<Lighting> lights;      // where there are luminaires, sun or sky
  LightPaths straight;                 // between two points
  std::vector<std::uint8_t> clear;     // per polygon: 1 for an opening
  std::vector<std::uint8_t> specular;  // per polygon: 1 for an opening, and for a mirror
  Eigen::Index bands;

  Batch trace(std::vector<Vertex> vertices, std::uint32_t paths, std::uint64_t seed) const;
  Spectrum relative_held_at(const Vertex& vertex, const Vector& direction) const;
  std::uint64_t rays_of(std::size_t count, double asked) const;
  std::vector<Vertex> starts(const PathReceiver& receiver, std::uint32_t paths, std::uint64_t seed) const;
  Spectrum light_from_lamps(const std::vector<Vertex>& vertices, const Samples& samples) const;
  Spectrum light_from_luminaires(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed,
                                 double asked) const;
  Spectrum light_from_outside(const std::vector<Vertex>& vertices, const std::vector<Ray>& rays,
                              const std::vector<std::optional<Hit>>& hits) const;
  std::optional<Vertex> next_vertex(const Hit& hit, const Spectrum& throughput, const PathSeed& path) const;
  Step scatter(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed) const;

  Spectrum light_in_mirrors(const std::vector<RayEnd>& ends, const std::vector<Vertex>& vertices) const;
};

// Points spread over the exposed part of the receiver.
std::vector<Vertex> PathTracer::starts(const PathReceiver& receiver, std::uint32_t paths, std::uint64_t seed) const {
  std::vector<Point> points;
  for (const auto& u : scrambled_sobol(paths, hash({seed, 0}))) {
    points.push_back(square_to_quad(receiver.corners, u[0], u[1]));
  }
  const std::vector<std::uint8_t> counts = exposed(occluder, surfaces, receiver, points, hash({seed, 1}));
  const Vector& normal = surfaces.at(receiver.polygon, receiver.side).normal;
  std::vector<Vertex> vertices;
  for (std::uint32_t k = 0; k < paths; ++k) {
    if (counts[k] != 0)
      vertices.push_back({points[k], normal, receiver.polygon, receiver.side, k, Spectrum::Ones(bands)});
  }
  return vertices;
}

// The relative response of a clear receiver to light from a unit direction; 1 at all other places.
Spectrum PathTracer::relative_held_at(const Vertex& vertex, const Vector& direction) const {
  if (vertex.polygon == no_polygon || clear[vertex.polygon] == 0) return Spectrum::Ones(bands);
  return relative_held(surfaces.at(vertex.polygon, vertex.side), vertex.normal.dot(direction));
}

// Light by points y on lamps, one for each vertex x: E(y) G / p with G = cos cos' / (pi |x - y|^2) and the density p of
// y, times the weight p / (p + G), as a scattered ray finds y with the density G.
Spectrum PathTracer::light_from_lamps(const std::vector<Vertex>& vertices, const Samples& samples) const {
  Spectrum sum = Spectrum::Zero(bands);
  if (!(lamps.flux > 0)) return sum;
  std::vector<Segment> segments;
  std::vector<Spectrum> unoccluded;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    const LampPoint lamp = sample(lamps, samples[k][0], samples[k][1]);
    const Surface& there = surfaces.at(lamp.polygon, lamp.side);
    const Vector toward = lamp.point - vertex.point;
    const double cosine = vertex.normal.dot(toward);        // times |x - y|
    const double cosine_there = -there.normal.dot(toward);  // times |x - y|
    if (!(cosine > 0 && cosine_there > 0)) continue;
    const double g = cosine * cosine_there / (std::numbers::pi * toward.squaredNorm() * toward.squaredNorm());
    segments.push_back({vertex.point, lamp.point, vertex.polygon, lamp.polygon});
    unoccluded.emplace_back(vertex.throughput * there.exitance * g / (sampling_density(lamps, there) + g));
    unoccluded.back() *= relative_held_at(vertex, toward.normalized());
    if (clear[lamp.polygon] != 0) unoccluded.back() *= relative_held(there, cosine_there / toward.norm());
  }
  const Field transmittance = straight.transmittance(segments);
  for (std::size_t k = 0; k < segments.size(); ++k)
    sum += unoccluded[k] * transmittance.row(static_cast<Eigen::Index>(k));
  return sum;
}

// Light of luminaires and sun by shadow rays from a share of the vertices, `asked`, chosen by chance.
Spectrum PathTracer::light_from_luminaires(const std::vector<Vertex>& vertices, const Samples& samples,
                                           std::uint64_t seed, double asked) const {
  Spectrum sum = Spectrum::Zero(bands);
  if (!lights) return sum;
  std::vector<LitPlace> places;
  std::vector<Spectrum> weights;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    if (asked < 1 && uniform({seed, vertex.path, 10}) >= asked) continue;
    weights.emplace_back(vertex.throughput / asked);
    places.push_back({{vertex.point, vertex.normal, vertex.polygon},
                      uniform({seed, vertex.path, 5}),
                      {samples[k][0], samples[k][1]}});
  }
  const Field found = irradiance_by_lights(*lights, places) + irradiance_in_mirrors(*lights, places);
  for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * found.row(static_cast<Eigen::Index>(k));
  return sum;
}

// Light of sky and ground by the scattered rays that meet nothing or an opening: pi L, as directions are distributed as
// cos(theta) / pi.
Spectrum PathTracer::light_from_outside(const std::vector<Vertex>& vertices, const std::vector<Ray>& rays,
                                        const std::vector<std::optional<Hit>>& hits) const {
  Spectrum sum = Spectrum::Zero(bands);
  if (!lights || !lights->sky) return sum;
  std::vector<Ray> leaving;
  std::vector<std::size_t> of_vertex;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (hits[k] && clear[hits[k]->polygon] == 0) continue;
    leaving.push_back(rays[k]);
    of_vertex.push_back(k);
  }
  const Field found = radiance_from_outside(*lights, leaving);
  for (std::size_t k = 0; k < leaving.size(); ++k)
    sum += std::numbers::pi * vertices[of_vertex[k]].throughput * found.row(static_cast<Eigen::Index>(k));
  return sum;
}

// Light of sky and ground that rays which leave mirrors find. pi L, as directions are distributed as cos(theta) / pi.
Spectrum PathTracer::light_in_mirrors(const std::vector<RayEnd>& ends, const std::vector<Vertex>& vertices) const {
  Spectrum sum = Spectrum::Zero(bands);
  if (!lights || !lights->sky) return sum;
  std::vector<Ray> rays;
  std::vector<Spectrum> factors;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    for (std::size_t m = 0; m < ends[k].mirrored.size(); ++m) {
      rays.push_back(ends[k].mirrored[m]);
      factors.emplace_back(vertices[k].throughput * ends[k].of_mirrored[m]);
    }
  }
  const Field found = radiance_from_outside(*lights, rays);
  for (std::size_t k = 0; k < rays.size(); ++k)
    sum += std::numbers::pi * factors[k] * found.row(static_cast<Eigen::Index>(k));
  return sum;
}

// One scattered ray from each vertex, backward along the light's way. A side that is not kept is black.
Step PathTracer::scatter(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed) const {
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    const Vector direction = square_to_cosine_hemisphere(samples[k][2], samples[k][3]);
    rays.push_back({vertex.point, frame_around(vertex.normal) * direction, vertex.polygon});
  }
  const auto hits = occluder.first_hits(rays);

  Step step{{}, light_from_outside(vertices, rays, hits)};
  std::vector<RayEnd> ends;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    ends.push_back(end_of({occluder, surfaces, specular}, hits[k], hash({seed, vertices[k].path})));
  step.irradiance += light_in_mirrors(ends, vertices);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const RayEnd& end = ends[k];
    if (!end.hit || !surfaces.at(end.hit->polygon, end.hit->side).kept) continue;
    const Vertex& vertex = vertices[k];
    const Hit& hit = *end.hit;
    const Spectrum throughput = vertex.throughput * end.factor * relative_held_at(vertex, rays[k].direction);
    const Surface& there = surfaces.at(hit.polygon, hit.side);

    // 1. A lamp: E(y) with the weight G / (p + G), and 1 in a mirror, where no point on it is looked for
    if (hit.reflections > 0) {
      step.irradiance += throughput * there.exitance;
    } else if ((there.exitance > 0).any()) {
      const double cosine = vertex.normal.dot(rays[k].direction);
      const double cosine_there = -there.normal.dot(hit.direction);
      // G / (p + G) with G = a / distance^2, as a / (p distance^2 + a): finite where a ray hardly gets off.
      const double a = std::max(0.0, cosine * cosine_there) / std::numbers::pi;
      const double by_area = sampling_density(lamps, there) * hit.distance * hit.distance;
      if (a > 0) step.irradiance += throughput * there.exitance * (a / (by_area + a));
    }

    // 2. What it scatters
    const std::optional<Vertex> next = next_vertex(hit, throughput, {vertex.path, seed});
    if (next) step.vertices.push_back(*next);
  }
  return step;
}

// Go on with the probability of the band that carries most, which then carries all it did: on the side that the ray has
// met, or on the other side of a sheet, from where light comes through.
std::optional<Vertex> PathTracer::next_vertex(const Hit& hit, const Spectrum& throughput, const PathSeed& path) const {
  const Surface& there = surfaces.at(hit.polygon, hit.side);
  const Spectrum reflected = throughput * reflectance_at(there, hit.point);
  const Spectrum through = throughput * there.scattered_through;
  const double survival = std::min((reflected + through).maxCoeff(), highest_survival);
  const double drawn = uniform({path.seed, path.path});
  if (drawn >= survival) return std::nullopt;
  const double on_this_side = survival * (reflected.maxCoeff() / (reflected.maxCoeff() + through.maxCoeff()));
  if (drawn < on_this_side)
    return Vertex{hit.point, there.normal, hit.polygon, hit.side, path.path, reflected / on_this_side};
  const Side other = hit.side == Side::front ? Side::back : Side::front;
  if (occluder.is_covered(hit.polygon, other, hit.point)) return std::nullopt;
  const Vector& normal = surfaces.at(hit.polygon, other).normal;
  return Vertex{hit.point, normal, hit.polygon, other, path.path, through / (survival - on_this_side)};
}

// Rays from so many vertices, of a share of which lights are asked.
std::uint64_t PathTracer::rays_of(std::size_t count, double asked) const {
  const int lights_each = lights ? (lights->luminaires.empty() ? 0 : 1) + (lights->sun ? 1 : 0) : 0;
  return 2 * count + static_cast<std::uint64_t>(std::lround(asked * static_cast<double>(count) * lights_each));
}

Batch PathTracer::trace(std::vector<Vertex> vertices, std::uint32_t paths, std::uint64_t seed) const {
  Batch batch{Spectrum::Zero(bands), static_cast<std::uint32_t>(vertices.size())};
  for (std::uint64_t length = 2; !vertices.empty(); ++length) {
    const std::uint32_t seed_here = hash({seed, length});
    const Samples samples = samples_at(vertices, paths, seed_here);
    batch.irradiance += light_from_lamps(vertices, samples);
    const double asked = length > many_bounces ? asked_of_many : 1;
    batch.irradiance += light_from_luminaires(vertices, samples, seed_here, asked);
    batch.rays += rays_of(vertices.size(), asked);
    Step step = scatter(vertices, samples, seed_here);
    batch.irradiance += step.irradiance;
    vertices = std::move(step.vertices);
  }
  return batch;
}

// The ratio of what all batches have found to their exposed points, with its standard error from the scatter of
// batches: those of one receiver are independent of each other. Two rows.
Field mean_and_error(std::span<const Batch> batches) {
  const auto count = static_cast<double>(batches.size());
  Field result = Field::Zero(2, batches.front().irradiance.size());
  double exposed = 0;
  for (const Batch& batch : batches) {
    result.row(0) += batch.irradiance;
    exposed += batch.exposed;
  }
  if (exposed == 0) return result;
  result.row(0) /= exposed;
  for (const Batch& batch : batches) {
    const Spectrum deviation = (batch.irradiance - result.row(0) * batch.exposed) / (exposed / count);
    result.row(1) += deviation.square() / (count * (count - 1));
  }
  result.row(1) = result.row(1).sqrt();
  return result;
}

PathTracer path_tracer_for(const Scene& scene, const KeptSides& sides, Reflections reflections) {
  const Surfaces surfaces = surfaces_of(scene, sides, reflections);
  const auto tracing =
      std::make_shared<const Tracing>(scene, find_coverings(scene, sides), Occluder::Blockers::all, reflections);
  PathTracer tracer{
      tracing, tracing->all_faces(scene), surfaces, lamps_of(scene, surfaces), {}, LightPaths(scene, *tracing), {},
      {},      number_of_bands(scene)};
  if (has_point_or_daylight(scene)) tracer.lights = lighting_of(scene, *tracing);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    tracer.clear.push_back(is_opening(scene, p) ? 1 : 0);
    const bool mirrors = is_mirror(scene, p, Side::front) || is_mirror(scene, p, Side::back);
    tracer.specular.push_back(tracer.clear.back() != 0 || mirrors ? 1 : 0);
  }
  return tracer;
}

// Starts of the paths of one batch: for a receiver, their number, and a seed.
using Starts = std::function<std::vector<Vertex>(std::size_t, std::uint32_t, std::uint64_t)>;

PathEstimate trace_all(const PathTracer& tracer, std::size_t receivers, const Starts& starts,
                       const PathOptions& options, const Observer& observer) {
  const std::uint32_t paths = std::bit_ceil((options.paths + path_batches - 1) / path_batches);  // of a batch
  std::vector<Batch> batches(receivers * path_batches);
  parallel_for(batches.size(), Stage::trace_paths, observer, [&](std::size_t k) {
    const std::uint64_t seed = hash({options.seed, 0x70617468, k});
    batches[k] = tracer.trace(starts(k / path_batches, paths, seed), paths, seed);
  });

  const auto rows = static_cast<Eigen::Index>(receivers);
  PathEstimate estimate{Field(rows, tracer.bands), Field(rows, tracer.bands), paths * path_batches};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::span<const Batch> own(&batches[static_cast<std::size_t>(i) * path_batches], path_batches);
    const Field result = mean_and_error(own);
    estimate.irradiance.row(i) = result.row(0);
    estimate.standard_error.row(i) = result.row(1);
    for (const Batch& batch : own) estimate.rays += batch.rays;
  }
  return estimate;
}

Reflections reflections_in(const PathOptions& options) {
  return options.follows_reflections ? Reflections::followed : Reflections::kept;
}

}  // namespace

PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const PathReceiver> receivers,
                              const PathOptions& options, const Observer& observer) {
  const PathTracer tracer = path_tracer_for(scene, sides, reflections_in(options));
  const auto starts = [&](std::size_t k, std::uint32_t paths, std::uint64_t seed) {
    return tracer.starts(receivers[k], paths, seed);
  };
  return trace_all(tracer, receivers.size(), starts, options, observer);
}

PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const Sensor> sensors,
                              const PathOptions& options, const Observer& observer) {
  const PathTracer tracer = path_tracer_for(scene, sides, reflections_in(options));
  const std::vector<Point> points = points_before_polygons(scene, sensors);
  const auto starts = [&](std::size_t k, std::uint32_t paths, std::uint64_t) {
    std::vector<Vertex> vertices;
    for (std::uint32_t path = 0; path < paths; ++path)
      vertices.push_back({points[k], sensors[k].normal, no_polygon, Side::front, path, Spectrum::Ones(tracer.bands)});
    return vertices;
  };
  return trace_all(tracer, sensors.size(), starts, options, observer);
}

}  // namespace patchlight
