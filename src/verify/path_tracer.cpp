#include "patchlight/verify/path_tracer.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/scene/coverings.h"
#include "patchlight/visibility/occluder.h"

#include "verify/exposed.h"
#include "verify/lamps.h"
#include "verify/surfaces.h"

#include <algorithm>
#include <bit>
#include <numbers>
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

namespace patchlight {
namespace {

// A path may go on for ever between surfaces that absorb nothing.
constexpr double highest_survival = 0.9999;

// A place where light arrives on its way to the receiver.
struct Vertex {
  Point point;
  PolygonIndex polygon = 0;
  Side side = Side::front;
  std::uint32_t path = 0;
  Spectrum throughput;  // share of the irradiance here that gets to the receiver
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
  const Samples ordered = scrambled_sobol(count, seed);
  if (count == 1) return ordered;
  const int unused = std::countl_zero(count - 1);
  Samples shuffled(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    shuffled[k] = ordered[owen_scramble(k << unused, hash({seed, 4})) >> unused];
  }
  return shuffled;
}

double uniform(std::initializer_list<std::uint64_t> counters) { return (hash(counters) + 0.5) * 0x1p-32; }

struct PathTracer {
  Occluder occluder;
  Surfaces surfaces;
  Lamps lamps;
  Eigen::Index bands;

  Batch trace(const Receiver& receiver, std::uint32_t paths, std::uint64_t seed) const;
  std::vector<Vertex> starts(const Receiver& receiver, std::uint32_t paths, std::uint64_t seed) const;
  Spectrum light_from_lamps(const std::vector<Vertex>& vertices, const Samples& samples) const;
  Step scatter(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed) const;
};

// Points spread over the exposed part of the receiver.
std::vector<Vertex> PathTracer::starts(const Receiver& receiver, std::uint32_t paths, std::uint64_t seed) const {
  std::vector<Point> points;
  for (const auto& u : scrambled_sobol(paths, hash({seed, 0}))) {
    points.push_back(square_to_quad(receiver.corners, u[0], u[1]));
  }
  const std::vector<std::uint8_t> counts = exposed(occluder, surfaces, receiver, points, hash({seed, 1}));
  std::vector<Vertex> vertices;
  for (std::uint32_t k = 0; k < paths; ++k) {
    if (counts[k] != 0) vertices.push_back({points[k], receiver.polygon, receiver.side, k, Spectrum::Ones(bands)});
  }
  return vertices;
}

// Light by points y on lamps, one for each vertex x: E(y) G / p with G = cos cos' / (pi |x - y|^2) and the density p of
// y, times the weight p / (p + G), as a scattered ray finds y with the density G.
Spectrum PathTracer::light_from_lamps(const std::vector<Vertex>& vertices, const Samples& samples) const {
  Spectrum sum = Spectrum::Zero(bands);
  if (!(lamps.flux > 0)) return sum;
  std::vector<Segment> segments;
  std::vector<Spectrum> unoccluded;
  for (const Vertex& vertex : vertices) {
    const LampPoint lamp = sample(lamps, samples[vertex.path][0], samples[vertex.path][1]);
    const Surface& there = surfaces.at(lamp.polygon, lamp.side);
    const Vector toward = lamp.point - vertex.point;
    const double cosine = surfaces.at(vertex.polygon, vertex.side).normal.dot(toward);  // times |x - y|
    const double cosine_there = -there.normal.dot(toward);                              // times |x - y|
    if (!(cosine > 0 && cosine_there > 0)) continue;
    const double g = cosine * cosine_there / (std::numbers::pi * toward.squaredNorm() * toward.squaredNorm());
    segments.push_back({vertex.point, lamp.point, vertex.polygon, lamp.polygon});
    unoccluded.emplace_back(vertex.throughput * there.exitance * g / (sampling_density(lamps, there) + g));
  }
  const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    if (blocked[k] == 0) sum += unoccluded[k];
  }
  return sum;
}

// One scattered ray from each vertex, backward along the light's way. A side that is not kept is black, and nothing
// comes from the open.
Step PathTracer::scatter(const std::vector<Vertex>& vertices, const Samples& samples, std::uint64_t seed) const {
  std::vector<Ray> rays;
  for (const Vertex& vertex : vertices) {
    const Vector direction = square_to_cosine_hemisphere(samples[vertex.path][2], samples[vertex.path][3]);
    const Vector& normal = surfaces.at(vertex.polygon, vertex.side).normal;
    rays.push_back({vertex.point, frame_around(normal) * direction, vertex.polygon});
  }
  const auto hits = occluder.first_hits(rays);

  Step step{{}, Spectrum::Zero(bands)};
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (!hits[k] || !surfaces.at(hits[k]->polygon, hits[k]->side).kept) continue;
    const Vertex& vertex = vertices[k];
    const Hit& hit = *hits[k];
    const Surface& there = surfaces.at(hit.polygon, hit.side);

    // 1. A lamp: E(y) with the weight G / (p + G)
    if ((there.exitance > 0).any()) {
      const double cosine = surfaces.at(vertex.polygon, vertex.side).normal.dot(rays[k].direction);
      const double cosine_there = -there.normal.dot(rays[k].direction);
      // G / (p + G) with G = a / distance^2, as a / (p distance^2 + a): finite where a ray hardly gets off.
      const double a = std::max(0.0, cosine * cosine_there) / std::numbers::pi;
      const double by_area = sampling_density(lamps, there) * hit.distance * hit.distance;
      if (a > 0) step.irradiance += vertex.throughput * there.exitance * (a / (by_area + a));
    }

    // 2. What it reflects: go on with the probability of the band that carries most, which then carries all it did
    const Spectrum reflected = vertex.throughput * there.reflectance;
    const double survival = std::min(reflected.maxCoeff(), highest_survival);
    if (uniform({seed, vertex.path}) >= survival) continue;
    step.vertices.push_back({hit.point, hit.polygon, hit.side, vertex.path, reflected / survival});
  }
  return step;
}

Batch PathTracer::trace(const Receiver& receiver, std::uint32_t paths, std::uint64_t seed) const {
  std::vector<Vertex> vertices = starts(receiver, paths, seed);
  Batch batch{Spectrum::Zero(bands), static_cast<std::uint32_t>(vertices.size())};
  for (std::uint64_t length = 2; !vertices.empty(); ++length) {
    const std::uint32_t seed_here = hash({seed, length});
    const Samples samples = shuffled_samples(paths, seed_here);
    batch.irradiance += light_from_lamps(vertices, samples);
    batch.rays += 2 * vertices.size();
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

}  // namespace

PathEstimate trace_irradiance(const Scene& scene, const KeptSides& sides, std::span<const Receiver> receivers,
                              const PathOptions& options, const Observer& observer) {
  const Surfaces surfaces = surfaces_of(scene, sides);
  const PathTracer tracer{Occluder(scene, Occluder::Blockers::all, find_coverings(scene, sides)), surfaces,
                          lamps_of(scene, surfaces), scene.materials.front().reflectance.size()};
  const std::uint32_t paths = std::bit_ceil((options.paths + path_batches - 1) / path_batches);  // of a batch
  std::vector<Batch> batches(receivers.size() * path_batches);
  parallel_for(batches.size(), Stage::trace_paths, observer, [&](std::size_t k) {
    batches[k] = tracer.trace(receivers[k / path_batches], paths, hash({options.seed, 0x70617468, k}));
  });

  const auto rows = static_cast<Eigen::Index>(receivers.size());
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

}  // namespace patchlight
