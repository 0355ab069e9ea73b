#include "lighting/mirrored_irradiance.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "lighting/receiver.h"
#include "lighting/receivers.h"
#include "lighting/shifted_points.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Independent estimates of each irradiance, at most: their spread is its standard error. Of few samples there are
// fewer.
constexpr std::uint32_t most_replicates = 8;
constexpr std::size_t most_mirrors_of_sky = 16;
constexpr int effort_at_points = 16;

// What one sample of a source gives a place if nothing is in the way.
struct MirroredArrival {
  Segment segment;  // from the place to the source
  Spectrum irradiance;
};

// Light that arrives at the image of a place from one direction, for each sample of a source.
using ArrivalAtImage = std::function<std::optional<MirroredArrival>(const SurfacePoint& at, const SurfacePoint& image,
                                                                    const Eigen::Vector2d& uv)>;

std::optional<MirroredArrival> arrived(const SurfacePoint& at, const Arrival& arrival) {
  if (!(arrival.irradiance > 0)) return {};
  return MirroredArrival{{at.point, arrival.from, at.polygon, no_polygon}, arrival.irradiance * *arrival.colour};
}

// E G A: one point of the lamp.
std::optional<MirroredArrival> from_lamp(const LampFace& lamp, const Point& y, const SurfacePoint& at,
                                         const SurfacePoint& image) {
  const Vector toward = y - image.point;
  const double cosine = image.normal.dot(toward);
  const double cosine_there = -lamp.normal.dot(toward);
  if (!(cosine > 0 && cosine_there > 0)) return {};
  const double geometry = cosine * cosine_there / (std::numbers::pi * toward.squaredNorm() * toward.squaredNorm());
  return MirroredArrival{{at.point, y, at.polygon, lamp.polygon}, geometry * lamp.area * lamp.exitance};
}

// Where a source is: in a ball, or in a direction.
struct SourceExtent {
  std::optional<Vector> direction;
  Ball ball;
};

struct MirroredSource {
  ArrivalAtImage arrival;
  SourceExtent extent;
};

std::vector<MirroredSource> mirrored_sources(const Lighting& lighting, std::span<const LampFace> lamps) {
  std::vector<MirroredSource> sources;
  for (const Luminaire& luminaire : lighting.luminaires) {
    const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light);
    sources.push_back({[&](const SurfacePoint& at, const SurfacePoint& image, const Eigen::Vector2d& uv) {
                         return arrived(at, from_luminaire(luminaire, lighting.up, image, uv));
                       },
                       {{}, {luminaire.position, sphere != nullptr ? sphere->radius : 0}}});
  }
  if (lighting.sun)
    sources.push_back({[&](const SurfacePoint& at, const SurfacePoint& image, const Eigen::Vector2d&) {
                         return arrived(at, from_sun(lighting, image));
                       },
                       {lighting.sun->direction, {}}});
  for (const LampFace& lamp : lamps)
    sources.push_back({[&lamp, points = QuadPoints(lamp.corners)](const SurfacePoint& at, const SurfacePoint& image,
                                                                  const Eigen::Vector2d& uv) {
                         return from_lamp(lamp, points.at(uv.x(), uv.y()), at, image);
                       },
                       {{}, ball_around(lamp.corners)}});
  return sources;
}

SurfacePoint image_of(const MirrorChain& chain, const SurfacePoint& at) {
  return {chain.image * at.point, chain.image.linear() * at.normal, at.polygon};
}

// A chain of mirrors, and the sources whose light may come by it.
struct WantedChain {
  const MirrorChain* chain;
  std::vector<const MirroredSource*> sources;
};

struct MirroredEstimate {
  Spectrum mean;
  Spectrum standard_error;
};

struct MirrorSampler {
  const Lighting& lighting;
  std::vector<MirroredSource> sources;
  std::vector<std::vector<std::array<double, 4>>> points;  // per replicate

  std::vector<WantedChain> chains_to(const Receiver& receiver) const;
  Spectrum over_chains(std::span<const WantedChain> chains, const std::vector<SurfacePoint>& places,
                       SamplePoints samples) const;
  Spectrum sky_in(std::span<const MirrorRay> rays) const;
  Spectrum of_sky(const std::vector<SurfacePoint>& places, SamplePoints samples, bool is_point) const;
  Field replicates_at(const Receiver& receiver, std::uint32_t key) const;
};

std::vector<WantedChain> MirrorSampler::chains_to(const Receiver& receiver) const {
  std::vector<WantedChain> wanted;
  if (sources.empty()) return wanted;
  const Ball ball = receiver.is_point() ? Ball{receiver.place(0, 0).point, 0} : ball_around(receiver.corners);
  const MirrorPaths& paths = lighting.mirrors->paths;
  for (const MirrorChain& chain : paths.chains()) {
    const MirrorSide& first = chain.mirrors.front();
    if (!(first.normal.dot(ball.centre - first.on_plane) > -ball.radius)) continue;
    WantedChain one{&chain, {}};
    for (const MirroredSource& source : sources) {
      const SourceExtent& extent = source.extent;
      const bool passes =
          extent.direction ? paths.may_pass(chain, ball, *extent.direction) : paths.may_pass(chain, ball, extent.ball);
      if (passes) one.sources.push_back(&source);
    }
    if (!one.sources.empty()) wanted.push_back(std::move(one));
  }
  return wanted;
}

// The sum over places.
Spectrum MirrorSampler::over_chains(std::span<const WantedChain> chains, const std::vector<SurfacePoint>& places,
                                    SamplePoints samples) const {
  Spectrum sum = Spectrum::Zero(lighting.bands);
  for (const auto& [chain, wanted] : chains) {
    std::vector<Segment> segments;
    std::vector<Spectrum> unoccluded;
    for (std::size_t k = 0; k < places.size(); ++k) {
      const MirrorSide& first = chain->mirrors.front();
      if (!(first.normal.dot(places[k].point - first.on_plane) > 0)) continue;
      const SurfacePoint image = image_of(*chain, places[k]);
      for (const MirroredSource* const source : wanted) {
        const auto arrival = source->arrival(places[k], image, {samples[k][2], samples[k][3]});
        if (!arrival) continue;
        segments.push_back(arrival->segment);
        unoccluded.push_back(arrival->irradiance);
      }
    }
    if (segments.empty()) continue;
    const Field share = lighting.mirrors->paths.transmittance(*chain, lighting.paths, segments);
    for (std::size_t k = 0; k < segments.size(); ++k) sum += unoccluded[k] * share.row(static_cast<Eigen::Index>(k));
  }
  return sum;
}

// Light of the sky in rays that leave mirrors.
Spectrum MirrorSampler::sky_in(std::span<const MirrorRay> rays) const {
  std::vector<Segment> segments;
  for (const auto& [ray, weight] : rays)
    segments.push_back({ray.origin, lighting.paths.beyond(ray.origin, ray.direction), ray.from_polygon, no_polygon});
  const Field share = lighting.paths.transmittance(segments);
  Spectrum sum = Spectrum::Zero(lighting.bands);
  for (std::size_t k = 0; k < rays.size(); ++k)
    sum += rays[k].weight * radiance(*lighting.sky, rays[k].ray.direction) * share.row(static_cast<Eigen::Index>(k));
  return sum;
}

// The sum over places. A point is one place, with all of the samples.
Spectrum MirrorSampler::of_sky(const std::vector<SurfacePoint>& places, SamplePoints samples, bool is_point) const {
  Spectrum sum = Spectrum::Zero(lighting.bands);
  if (!lighting.sky) return sum;
  const MirrorView& view = lighting.mirrors->view;
  std::vector<MirrorRay> rays;
  if (is_point) {
    view.add_rays(places[0], samples, rays);
    for (MirrorRay& ray : rays) ray.weight *= static_cast<double>(places.size());
  } else {
    for (std::size_t k = 0; k < places.size(); ++k) {
      const std::array<std::array<double, 4>, 2> pair{samples[k], samples[(k + 1) % places.size()]};
      view.add_rays(places[k], pair, rays);
    }
  }
  for (std::size_t mirrors = 1; mirrors <= most_mirrors_of_sky && !rays.empty(); ++mirrors) {
    sum += sky_in(rays);
    rays = view.further(rays, is_point ? 1 : std::numbers::pi);
  }
  return sum;
}

// One row each, of those with a place over which no other polygon lies.
Field MirrorSampler::replicates_at(const Receiver& receiver, std::uint32_t key) const {
  Field found = Field::Zero(static_cast<Eigen::Index>(points.size()), lighting.bands);
  const std::vector<WantedChain> chains = chains_to(receiver);
  Eigen::Index count = 0;
  for (std::uint32_t r = 0; r < points.size(); ++r) {
    const auto samples = shifted(points[r], hash({key, r}));
    std::vector<SurfacePoint> places;
    std::vector<std::array<double, 4>> of_places;
    for (const auto& sample : samples) {
      const SurfacePoint at = receiver.place(sample[0], sample[1]);
      if (is_covered(lighting, receiver, at)) continue;
      places.push_back(at);
      of_places.push_back(sample);
    }
    if (places.empty()) continue;
    const Spectrum sum = over_chains(chains, places, of_places) + of_sky(places, of_places, receiver.is_point());
    found.row(count++) = sum / static_cast<double>(places.size());
  }
  return found.topRows(count);
}

// The mean of replicates and its standard error, as large as itself where there is one alone; 0 where there is none.
MirroredEstimate estimate_from(const Field& replicates) {
  const Eigen::Index count = replicates.rows();
  if (count == 0) return {Spectrum::Zero(replicates.cols()), Spectrum::Zero(replicates.cols())};
  const Spectrum mean = replicates.colwise().mean();
  if (count == 1) return {mean, mean};
  const Spectrum squares = replicates.square().colwise().mean();
  return {mean, ((squares - mean.square()).max(0.0) / static_cast<double>(count - 1)).sqrt()};
}

DirectIrradiance in_mirrors_at(const Lighting& lighting, std::span<const LampFace> lamps,
                               const std::vector<Receiver>& receivers, const LightingOptions& options, int effort,
                               const Observer& observer) {
  MirrorSampler sampler{lighting, mirrored_sources(lighting, lamps), {}};
  const auto samples = std::bit_ceil(static_cast<std::uint32_t>(std::max(2, effort * options.mirrored_samples)));
  const std::uint32_t replicates = std::min(most_replicates, std::max(2U, samples / 2));
  for (std::uint32_t r = 0; r < replicates; ++r)
    sampler.points.push_back(scrambled_sobol(samples / replicates, hash({options.seed, r, 7})));
  const auto rows = static_cast<Eigen::Index>(receivers.size());
  DirectIrradiance direct{Field::Zero(rows, lighting.bands), Field::Zero(rows, lighting.bands)};
  parallel_for(receivers.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const MirroredEstimate found = estimate_from(sampler.replicates_at(receivers[k], hash({options.seed, k, 8})));
    direct.irradiance.row(static_cast<Eigen::Index>(k)) = found.mean;
    direct.standard_error.row(static_cast<Eigen::Index>(k)) = found.standard_error;
  });
  return direct;
}

}  // namespace

Mirrors::Mirrors(const Scene& scene, const Tracing& tracing) : paths(scene), view(scene, paths.sides(), tracing) {}

std::vector<LampFace> lamp_faces(const Scene& scene, PolygonIndex polygon, Side side) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  const Spectrum& exitance = scene.materials[material_on(scene.polygons[polygon], side)].exitance;
  const Vector normal = (side == Side::front ? 1 : -1) * front_normal(scene, polygon);
  std::vector<LampFace> faces;
  if (corners.size() == 4 && is_convex(corners)) {
    faces.push_back(
        {{corners[0], corners[1], corners[2], corners[3]}, normal, area_vector(corners).norm(), polygon, exitance});
    return faces;
  }
  for (const auto& [a, b, c] : triangles_of(corners))
    faces.push_back({{a, b, c, c}, normal, (b - a).cross(c - a).norm() / 2, polygon, exitance});
  return faces;
}

DirectIrradiance mirrored_irradiance(const Lighting& lighting, std::span<const LampFace> lamps, const PatchMesh& mesh,
                                     const LightingOptions& options, const Observer& observer) {
  return in_mirrors_at(lighting, lamps, receivers_of(mesh), options, 1, observer);
}

DirectIrradiance mirrored_irradiance(const Lighting& lighting, std::span<const LampFace> lamps,
                                     std::span<const SurfacePoint> points, const LightingOptions& options,
                                     const Observer& observer) {
  return in_mirrors_at(lighting, lamps, receivers_of(points), options, effort_at_points, observer);
}

}  // namespace patchlight
