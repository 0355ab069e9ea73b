// Radiosity B and irradiance H of a diffuse scene obey, at every point x (Kajiya 1986),
//
//   H(x) = int L(x, w) cos(theta) dw,    L(x, w) = B(y) / pi,    B(y) = E(y) + rho(y) H(y),
//
// y the point that x sees in the direction w. Directions are distributed as cos(theta) / pi, so that one of them
// estimates H(x) by B(y); rho(y) H(y) is found in the same way, and so on: a path. It goes on with a probability, and
// what goes on is divided by it, which keeps the mean (Russian roulette, Arvo and Kirk 1990).
//
// Points on lamps and shadow rays also find E(y), as a path seldom meets a small lamp. Light that both find is weighted
// by their densities (balance heuristic, Veach and Guibas 1995). With points on lamps alone, the variance would be
// infinite beside a lamp.
//
// No scattered ray meets luminaires or the sun: shadow rays find them. Scattered rays alone find the sky, if they leave
// the scene.
//
// A sheet has B(y) = E(y) + rho(y) H(y) + tau(y) H(y, other side): a path that meets it goes on from either side.
//
// A ray that meets a mirror or a clear polygon goes through it, or is reflected, or ends there, at random. Such rays
// alone find lamps and sky in mirrors. Luminaires and sun in mirrors are found by random chains of images.
//
// The tracer shares the ray caster and the scene with the solver, and nothing else.
#include "verify/path_tracer.h"

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "scene/extent.h"
#include "scene/triangulate.h"
#include "verify/delta_sources.h"
#include "verify/path_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// A piece of an emitting side.
struct LampTriangle {
  Triangle corners;
  PolygonIndex polygon = 0;
  Side side = Side::front;
};

// A point of an emitting side.
struct LampPoint {
  Point point;
  PolygonIndex polygon = 0;
  Side side = Side::front;
};

// All that emits, to be sampled by area: each square meter in proportion to its exitance, mean of the bands.
struct Lamps {
  std::vector<LampTriangle> triangles;
  std::vector<double> flux_before;  // of the triangles before each, mean of the bands, W
  double flux = 0;                  // of all, W
};

Lamps lamps_of(const Scene& scene, const Surfaces& surfaces) {
  Lamps lamps;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      const double exitance = surfaces.at(p, side).exitance.mean();
      if (!(exitance > 0)) continue;
      for (const Triangle& corners : triangles_of(corner_points(scene, p))) {
        lamps.triangles.push_back({corners, p, side});
        lamps.flux_before.push_back(lamps.flux);
        lamps.flux += exitance * (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
      }
    }
  }
  return lamps;
}

// The point of (u, v) in the unit square, with the density sampling_density(). There must be a lamp.
LampPoint sample(const Lamps& lamps, double u, double v) {
  assert(lamps.flux > 0);
  // The triangle whose share of the flux holds u, which is stretched over that share to be used again.
  const double wanted = u * lamps.flux;
  const auto above = std::upper_bound(lamps.flux_before.begin() + 1, lamps.flux_before.end(), wanted);
  const auto t = static_cast<std::size_t>(std::distance(lamps.flux_before.begin(), above)) - 1;
  const double end = t + 1 < lamps.flux_before.size() ? lamps.flux_before[t + 1] : lamps.flux;
  const double stretched = (wanted - lamps.flux_before[t]) / (end - lamps.flux_before[t]);

  const LampTriangle& triangle = lamps.triangles[t];
  const auto& [p0, p1, p2] = triangle.corners;
  const Eigen::Vector2d b = square_to_triangle(std::clamp(stretched, 0.0, 1.0), v);
  return {p0 + b[0] * (p1 - p0) + b[1] * (p2 - p0), triangle.polygon, triangle.side};
}

// The density with which points of a surface are sampled, 1/m^2.
double sampling_density(const Lamps& lamps, const Surface& surface) { return surface.exitance.mean() / lamps.flux; }

// A polygon, and the distance within which a sensor lies on it.
struct Surround {
  std::vector<Point> corners;
  Vector normal;
  Box box;
  double tolerance = 0;

  bool touches(const Point& point) const;
};

double distance_to_segment(const Point& point, const Point& a, const Point& b) {
  const double along = std::clamp((point - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (point - a - along * (b - a)).norm();
}

// Inside the outline, by the winding number of its edges around the point, or near an edge. The two ways along a seam
// cancel.
bool Surround::touches(const Point& point) const {
  if (box.squaredExteriorDistance(point) > tolerance * tolerance) return false;
  if (std::abs(normal.dot(point - corners[0])) > tolerance) return false;
  double angle = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Point& next = corners[(k + 1) % corners.size()];
    if (distance_to_segment(point, corners[k], next) <= tolerance) return true;
    const Vector a = corners[k] - point;
    const Vector b = next - point;
    angle += std::atan2(a.cross(b).dot(normal), a.dot(b));
  }
  return std::abs(angle) > std::numbers::pi;
}

// The points from which sensors are read. A sensor lies on a polygon if it is nearer than 1e-5 of the polygon's size
// or 1e-6 of the scene's. It is then moved in front of the side that it faces along, by 2e-9 of the scene's extent: the
// ray caster resolves half of that. O(sensors x corners).
std::vector<Point> points_before_polygons(const Scene& scene, std::span<const Sensor> sensors) {
  const double extent = extent_of(scene);
  std::vector<Surround> polygons;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    Surround polygon{corner_points(scene, p), front_normal(scene, p), {}, 0};
    for (const Point& corner : polygon.corners) polygon.box.extend(corner);
    polygon.tolerance = std::max(1e-5 * polygon.box.diagonal().norm(), tolerance_of_coordinates * extent);
    polygons.push_back(std::move(polygon));
  }
  std::vector<Point> points(sensors.size());
  parallel_for(points.size(), [&](std::size_t k) {
    points[k] = sensors[k].point;
    for (const Surround& polygon : polygons) {
      if (!polygon.touches(points[k])) continue;
      const double facing = polygon.normal.dot(sensors[k].normal) < 0 ? -1 : 1;
      points[k] += (facing * 2e-9 * extent - polygon.normal.dot(points[k] - polygon.corners[0])) * polygon.normal;
    }
  });
  return points;
}

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

// The light of a batch of paths.
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

// A step of all paths of a batch.
struct PathStep {
  std::uint32_t paths = 0;
  std::uint64_t seed = 0;
  double asked = 1;  // share of the vertices that send shadow rays to luminaires and sun
};

using Samples = std::vector<std::array<double, 4>>;

// A random permutation of the numbers below `count`, a power of two, that keeps strata.
std::uint32_t shuffled_index(std::uint32_t k, std::uint32_t count, std::uint32_t seed) {
  if (count == 1) return 0;
  const int unused = std::countl_zero(count - 1);
  return owen_scramble(k << unused, seed) >> unused;
}

// A stratified sample for each path. Samples of different seeds are in unrelated orders, or the same path would get the
// same strata each time (Burley 2020, section 5). `count` is a power of two.
Samples shuffled_samples(std::uint32_t count, std::uint32_t seed) {
  const Samples ordered = scrambled_sobol(count, seed);
  Samples shuffled(count);
  for (std::uint32_t k = 0; k < count; ++k)
    shuffled[k] = ordered[shuffled_index(k, count, hash({seed, stream::path_order}))];
  return shuffled;
}

// One sample per vertex. If few of the paths remain, strata no longer reduce the variance: then the samples are
// independent, and cost no more than these paths.
Samples samples_at(const std::vector<Vertex>& vertices, std::uint32_t paths, std::uint32_t seed) {
  Samples samples(vertices.size());
  if (8 * vertices.size() < paths) {
    for (std::size_t k = 0; k < vertices.size(); ++k)
      for (std::size_t d = 0; d < 4; ++d) samples[k][d] = uniform({seed, vertices[k].path, stream::path_vertices + d});
    return samples;
  }
  const Samples of_paths = shuffled_samples(paths, seed);
  for (std::size_t k = 0; k < vertices.size(); ++k) samples[k] = of_paths[vertices[k].path];
  return samples;
}

class PathTracer {
 public:
  PathTracer(const Scene& scene, const KeptSides& sides, const PathOptions& options)
      : scene_(scene, sides, options.follows_reflections ? Reflections::followed : Reflections::kept),
        surfaces_(scene_.surfaces()),
        lamps_(lamps_of(scene, surfaces_)),
        sources_(scene, scene_),
        mirrors_(scene, scene_, sources_, options.seed) {
    if (scene.sky) sky_.emplace(*scene.sky, scene.up);
  }

  Eigen::Index bands() const { return scene_.bands(); }
  std::vector<Vertex> starts(const PathReceiver& receiver, std::uint32_t paths, std::uint64_t seed) const;
  std::vector<Vertex> starts(const PathRegion& region, std::uint32_t paths, std::uint64_t seed) const;
  Batch trace(std::vector<Vertex> vertices, std::uint32_t paths, std::uint64_t seed) const;

 private:
  Spectrum nonspecular_profile_at(const Vertex& vertex, const Vector& direction) const;
  std::uint64_t rays_of(std::size_t count, double asked) const;
  Spectrum light_from_lamps(const std::vector<Vertex>& vertices, const Samples& samples) const;
  Spectrum light_from_sources(const std::vector<Vertex>& vertices, const Samples& samples, const PathStep& step) const;
  Spectrum light_in_mirrors(const Vertex& vertex, const std::array<double, 4>& sample, const PathStep& step) const;
  std::optional<Vertex> next_vertex(const Hit& hit, const Spectrum& throughput, const PathSeed& path) const;
  Step scatter(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed) const;

  PathScene scene_;
  const Surfaces& surfaces_;
  Lamps lamps_;
  DeltaSources sources_;
  std::optional<SkyRadiance> sky_;
  MirrorImages mirrors_;
};

// Points spread over the exposed part of the receiver.
std::vector<Vertex> PathTracer::starts(const PathReceiver& receiver, std::uint32_t paths, std::uint64_t seed) const {
  std::vector<Point> points;
  for (const auto& u : scrambled_sobol(paths, hash({seed, stream::path_starts}))) {
    points.push_back(square_to_quad(receiver.corners, u[0], u[1]));
  }
  const std::vector<std::uint8_t> counts =
      exposed(scene_.faces(), surfaces_, receiver, points, hash({seed, stream::exposed_points}));
  const Vector& normal = surfaces_.at(receiver.polygon, receiver.side).normal;
  std::vector<Vertex> vertices;
  for (std::uint32_t k = 0; k < paths; ++k) {
    if (counts[k] != 0)
      vertices.push_back({points[k], normal, receiver.polygon, receiver.side, k, Spectrum::Ones(bands())});
  }
  return vertices;
}

// The same over a region: each path takes a receiver by area, stratified, and a point of its own there.
std::vector<Vertex> PathTracer::starts(const PathRegion& region, std::uint32_t paths, std::uint64_t seed) const {
  std::vector<double> area_up_to;
  double whole = 0;
  for (const PathReceiver& receiver : region.receivers)
    area_up_to.push_back(whole += area_vector(receiver.corners).norm());
  const Samples samples = scrambled_sobol(paths, hash({seed, stream::path_starts}));
  std::vector<Vertex> vertices;
  for (std::uint32_t k = 0; k < paths; ++k) {
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, samples[k][2] * whole);
    const PathReceiver& receiver = region.receivers[static_cast<std::size_t>(found - area_up_to.begin())];
    const Point point = square_to_quad(receiver.corners, samples[k][0], samples[k][1]);
    const std::uint32_t seed_here = hash({seed, stream::exposed_points, k});
    if (exposed(scene_.faces(), surfaces_, receiver, {&point, 1}, seed_here).front() == 0) continue;
    const Vector& normal = surfaces_.at(receiver.polygon, receiver.side).normal;
    vertices.push_back({point, normal, receiver.polygon, receiver.side, k, Spectrum::Ones(bands())});
  }
  return vertices;
}

// The relative response of a clear receiver to light from a unit direction; 1 at all other places.
Spectrum PathTracer::nonspecular_profile_at(const Vertex& vertex, const Vector& direction) const {
  if (vertex.polygon == no_polygon || !surfaces_.at(vertex.polygon, vertex.side).is_clear)
    return Spectrum::Ones(bands());
  return nonspecular_profile(surfaces_.at(vertex.polygon, vertex.side), vertex.normal.dot(direction));
}

// Light by points y on lamps, one for each vertex x: E(y) G / p with G = cos cos' / (pi |x - y|^2) and the density p of
// y, times the weight p / (p + G), as a scattered ray finds y with the density G.
Spectrum PathTracer::light_from_lamps(const std::vector<Vertex>& vertices, const Samples& samples) const {
  Spectrum sum = Spectrum::Zero(bands());
  if (!(lamps_.flux > 0)) return sum;
  std::vector<Segment> segments;
  std::vector<Spectrum> unoccluded;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    const LampPoint lamp = sample(lamps_, samples[k][0], samples[k][1]);
    const Surface& there = surfaces_.at(lamp.polygon, lamp.side);
    const Vector toward = lamp.point - vertex.point;
    const double cosine = vertex.normal.dot(toward);        // times |x - y|
    const double cosine_there = -there.normal.dot(toward);  // times |x - y|
    if (!(cosine > 0 && cosine_there > 0)) continue;
    const double g = cosine * cosine_there / (std::numbers::pi * toward.squaredNorm() * toward.squaredNorm());
    segments.push_back({vertex.point, lamp.point, vertex.polygon, lamp.polygon});
    unoccluded.emplace_back(vertex.throughput * there.exitance * g / (sampling_density(lamps_, there) + g));
    unoccluded.back() *= nonspecular_profile_at(vertex, toward.normalized());
    if (there.is_clear) unoccluded.back() *= nonspecular_profile(there, cosine_there / toward.norm());
  }
  const Field transmittance = scene_.transmittance(segments);
  for (std::size_t k = 0; k < segments.size(); ++k)
    sum += unoccluded[k] * transmittance.row(static_cast<Eigen::Index>(k));
  return sum;
}

// Light of luminaires and sun by shadow rays from some of the vertices.
Spectrum PathTracer::light_from_sources(const std::vector<Vertex>& vertices, const Samples& samples,
                                        const PathStep& step) const {
  Spectrum sum = Spectrum::Zero(bands());
  if (sources_.empty()) return sum;
  std::vector<Segment> segments;
  std::vector<Spectrum> unoccluded;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    if (step.asked < 1 && uniform({step.seed, vertex.path, stream::vertex_sends_shadow_rays}) >= step.asked) continue;
    const Eigen::Vector2d on_luminaire(samples[k][0], samples[k][1]);
    for (const LightSample& light : sources_.sample(
             {vertex.point, vertex.normal}, uniform({step.seed, vertex.path, stream::path_luminaire}), on_luminaire)) {
      segments.push_back({vertex.point, light.from, vertex.polygon, no_polygon});
      unoccluded.emplace_back(vertex.throughput * light.irradiance);
    }
    if (!mirrors_.empty()) sum += vertex.throughput * light_in_mirrors(vertex, samples[k], step);
  }
  const Field transmittance = scene_.transmittance(segments);
  for (std::size_t k = 0; k < segments.size(); ++k)
    sum += unoccluded[k] * transmittance.row(static_cast<Eigen::Index>(k));
  return sum / step.asked;
}

// The first mirror is stratified over the paths: few of many mirrors may light a place.
Spectrum PathTracer::light_in_mirrors(const Vertex& vertex, const std::array<double, 4>& sample,
                                      const PathStep& step) const {
  const double jitter = uniform({step.seed, vertex.path, stream::mirror_jitter});
  const std::uint32_t place = shuffled_index(vertex.path, step.paths, hash({step.seed, stream::mirror_order}));
  return mirrors_.sample_irradiance({vertex.point, vertex.normal}, vertex.polygon,
                                    {.first_mirror = (place + jitter) / step.paths,
                                     .luminaire = uniform({step.seed, vertex.path, stream::mirror_luminaire}),
                                     .on_luminaire = {sample[0], sample[1]},
                                     .seed = hash({step.seed, vertex.path, stream::mirror_chain})});
}

// One scattered ray from each vertex, backward along the light's way. A side that is not kept is black.
Step PathTracer::scatter(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed) const {
  std::vector<Ray> rays;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    const Vector direction = square_to_cosine_hemisphere(samples[k][2], samples[k][3]);
    rays.push_back({vertex.point, frame_around(vertex.normal) * direction, vertex.polygon});
  }
  const auto hits = scene_.faces().first_hits(rays);

  Step step{{}, Spectrum::Zero(bands())};
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vertex& vertex = vertices[k];
    const RayEnd end = walk_to_end(scene_, hits[k], rays[k].direction, hash({seed, vertex.path}));
    const Spectrum throughput = vertex.throughput * end.factor * nonspecular_profile_at(vertex, rays[k].direction);
    // pi L, as directions are distributed as cos(theta) / pi.
    if (!end.hit && sky_) step.irradiance += std::numbers::pi * throughput * sky_->radiance_from(end.direction);
    if (!end.hit || !surfaces_.at(end.hit->polygon, end.hit->side).kept) continue;
    const Hit& hit = *end.hit;
    const Surface& there = surfaces_.at(hit.polygon, hit.side);

    // 1. A lamp: E(y) with the weight G / (p + G), and 1 in a mirror, where no point on it is looked for
    if (hit.reflections > 0) {
      step.irradiance += throughput * there.exitance;
    } else if ((there.exitance > 0).any()) {
      const double cosine = vertex.normal.dot(rays[k].direction);
      const double cosine_there = -there.normal.dot(hit.direction);
      // G / (p + G) with G = a / distance^2, as a / (p distance^2 + a): finite where a ray hardly gets off.
      const double a = std::max(0.0, cosine * cosine_there) / std::numbers::pi;
      const double by_area = sampling_density(lamps_, there) * hit.distance * hit.distance;
      if (a > 0) step.irradiance += throughput * there.exitance * (a / (by_area + a));
    }

    // 2. Scattered light
    const std::optional<Vertex> next = next_vertex(hit, throughput, {vertex.path, seed});
    if (next) step.vertices.push_back(*next);
  }
  return step;
}

// Go on with the probability of the band that carries most, which then carries all it did: on the side that the ray has
// met, or on the other side of a sheet, from where light comes through.
std::optional<Vertex> PathTracer::next_vertex(const Hit& hit, const Spectrum& throughput, const PathSeed& path) const {
  const Surface& there = surfaces_.at(hit.polygon, hit.side);
  const Spectrum reflected = throughput * reflectance_at(there, hit.point);
  const Spectrum through = throughput * there.scattered_through;
  // Below 1, as a path between surfaces that absorb nothing would not end.
  const double survival = std::min((reflected + through).maxCoeff(), 0.9999);
  const double drawn = uniform({path.seed, path.path});
  if (drawn >= survival) return std::nullopt;
  const double on_this_side = survival * (reflected.maxCoeff() / (reflected.maxCoeff() + through.maxCoeff()));
  if (drawn < on_this_side)
    return Vertex{hit.point, there.normal, hit.polygon, hit.side, path.path, reflected / on_this_side};
  const Side other = hit.side == Side::front ? Side::back : Side::front;
  if (scene_.faces().is_covered(hit.polygon, other, hit.point)) return std::nullopt;
  const Vector& normal = surfaces_.at(hit.polygon, other).normal;
  return Vertex{hit.point, normal, hit.polygon, other, path.path, through / (survival - on_this_side)};
}

// The number of rays from these vertices; `asked` is the share of vertices that send shadow rays.
std::uint64_t PathTracer::rays_of(std::size_t count, double asked) const {
  const auto to_sources = static_cast<double>(count * sources_.rays_per_point());
  return 2 * count + static_cast<std::uint64_t>(std::lround(asked * to_sources));
}

Batch PathTracer::trace(std::vector<Vertex> vertices, std::uint32_t paths, std::uint64_t seed) const {
  Batch batch{Spectrum::Zero(bands()), static_cast<std::uint32_t>(vertices.size())};
  // Lengths 0 and 1 would repeat the streams path_starts and exposed_points.
  for (std::uint64_t length = 2; !vertices.empty(); ++length) {
    const std::uint32_t seed_here = hash({seed, length});
    const Samples samples = samples_at(vertices, paths, seed_here);
    batch.irradiance += light_from_lamps(vertices, samples);
    // Paths between white faces have thousands of vertices: of the later ones one in 16 sends rays to luminaires.
    const double asked = length > 32 ? 1.0 / 16 : 1;
    batch.irradiance += light_from_sources(vertices, samples, {paths, seed_here, asked});
    batch.rays += rays_of(vertices.size(), asked);
    Step step = scatter(vertices, samples, seed_here);
    batch.irradiance += step.irradiance;
    vertices = std::move(step.vertices);
  }
  return batch;
}

// The light of all batches over their exposed points, and its standard error from the scatter of the batches, which
// are independent of each other. Two rows.
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

// Starts of the paths of one batch: for a receiver, their number, and a seed.
using Starts = std::function<std::vector<Vertex>(std::size_t, std::uint32_t, std::uint64_t)>;

PathEstimate trace_all(const PathTracer& tracer, std::size_t receivers, const Starts& starts,
                       const PathOptions& options, const Observer& observer) {
  const std::uint32_t paths = std::bit_ceil((options.paths + path_batches - 1) / path_batches);  // of a batch
  std::vector<Batch> batches(receivers * path_batches);
  parallel_for(batches.size(), Stage::trace_paths, observer, [&](std::size_t k) {
    const std::uint64_t seed = hash({options.seed, stream::path_seeds, k});
    batches[k] = tracer.trace(starts(k / path_batches, paths, seed), paths, seed);
  });

  const auto rows = static_cast<Eigen::Index>(receivers);
  PathEstimate estimate{Field(rows, tracer.bands()), Field(rows, tracer.bands()), paths * path_batches};
  for (Eigen::Index i = 0; i < rows; ++i) {
    const std::span<const Batch> own(&batches[static_cast<std::size_t>(i) * path_batches], path_batches);
    const Field result = mean_and_error(own);
    estimate.irradiance.row(i) = result.row(0);
    estimate.standard_error.row(i) = result.row(1);
    for (const Batch& batch : own) estimate.rays += batch.rays;
  }
  return estimate;
}

// The same for patches and for regions, on which paths start at random.
template <class Receiver>
PathEstimate trace_from_surfaces(const Scene& scene, const KeptSides& sides, std::span<const Receiver> receivers,
                                 const PathOptions& options, const Observer& observer) {
  const PathTracer tracer(scene, sides, options);
  const auto starts = [&](std::size_t k, std::uint32_t paths, std::uint64_t seed) {
    return tracer.starts(receivers[k], paths, seed);
  };
  return trace_all(tracer, receivers.size(), starts, options, observer);
}

}  // namespace

PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const PathReceiver> receivers,
                              const PathOptions& options, const Observer& observer) {
  return trace_from_surfaces(scene, sides, receivers, options, observer);
}

PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const PathRegion> regions,
                              const PathOptions& options, const Observer& observer) {
  return trace_from_surfaces(scene, sides, regions, options, observer);
}

PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const Sensor> sensors,
                              const PathOptions& options, const Observer& observer) {
  const PathTracer tracer(scene, sides, options);
  const std::vector<Point> points = points_before_polygons(scene, sensors);
  const auto starts = [&](std::size_t k, std::uint32_t paths, std::uint64_t) {
    std::vector<Vertex> vertices;
    for (std::uint32_t path = 0; path < paths; ++path)
      vertices.push_back({points[k], sensors[k].normal, no_polygon, Side::front, path, Spectrum::Ones(tracer.bands())});
    return vertices;
  };
  return trace_all(tracer, sensors.size(), starts, options, observer);
}

}  // namespace patchlight
