#include "patchlight/lighting/direct_irradiance.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace patchlight {
namespace {

using Sobol = std::vector<std::array<double, 4>>;

// Independent estimates of each irradiance: their spread is its standard error.
constexpr std::uint32_t replicates = 4;

// Scrambles of the Sobol points that patches and sources choose from; odd steps lead through all of them.
constexpr std::uint32_t scrambles = 64;
constexpr std::uint32_t step = 17;

// A place of the surface for each point of the unit square, and the side it is on.
struct Receiver {
  std::function<SurfacePoint(double, double)> place;
  bool is_point = false;
  Side side = Side::front;
};

// Something that gives light: how it arrives at a point, for a point of the unit square.
struct Source {
  std::function<Arrival(const SurfacePoint&, const Eigen::Vector2d&)> arrival;
  std::uint32_t samples = 0;
  bool has_extent = false;
};

// Irradiance by one source.
struct Estimate {
  Spectrum mean;
  Spectrum variance;  // of the mean
};

struct Estimator {
  const Lighting& lighting;
  std::vector<Source> sources;
  std::vector<Sobol> points;

  Spectrum mean(const Receiver& receiver, const Source& source, std::span<const std::array<double, 4>> samples) const;
  Estimate estimate(const Receiver& receiver, const Source& source, std::uint32_t key) const;
  Estimate total(const Receiver& receiver, std::uint64_t seed, std::uint64_t index) const;
};

std::vector<Source> sources_of(const Lighting& lighting, const LightingOptions& options) {
  std::vector<Source> sources;
  for (const Luminaire& luminaire : lighting.luminaires) {
    sources.push_back({[&lighting, &luminaire](const SurfacePoint& at, const Eigen::Vector2d& uv) {
                         return from_luminaire(luminaire, lighting.up, at, uv);
                       },
                       static_cast<std::uint32_t>(options.lamp_samples),
                       std::holds_alternative<SphericalLamp>(luminaire.light)});
  }
  if (lighting.sun) {
    sources.push_back({[&lighting](const SurfacePoint& at, const Eigen::Vector2d&) { return from_sun(lighting, at); },
                       static_cast<std::uint32_t>(options.sun_samples), false});
  }
  if (lighting.sky) {
    sources.push_back(
        {[&lighting](const SurfacePoint& at, const Eigen::Vector2d& uv) { return from_sky(lighting, at, uv); },
         static_cast<std::uint32_t>(options.sky_samples), true});
  }
  return sources;
}

Estimator estimator_for(const Lighting& lighting, const LightingOptions& options) {
  const int most = std::max({options.lamp_samples, options.sun_samples, options.sky_samples});
  Estimator estimator{lighting, sources_of(lighting, options), {}};
  for (std::uint32_t k = 0; k < scrambles; ++k) {
    estimator.points.push_back(scrambled_sobol(
        std::max<std::uint32_t>(1, static_cast<std::uint32_t>(most) / replicates), hash({options.seed, k})));
  }
  return estimator;
}

// Places over which another polygon lies do not count.
Spectrum Estimator::mean(const Receiver& receiver, const Source& source,
                         std::span<const std::array<double, 4>> samples) const {
  std::vector<Segment> segments;
  std::vector<Arrival> arrivals;
  std::size_t exposed = 0;
  for (const auto& [u, v, s, t] : samples) {
    const SurfacePoint at = receiver.place(u, v);
    if (at.polygon != no_polygon && lighting.paths.is_covered(at.polygon, receiver.side, at.point)) continue;
    ++exposed;
    const Arrival arrival = source.arrival(at, {s, t});
    if (!(arrival.irradiance > 0)) continue;
    segments.push_back({at.point, arrival.from, at.polygon, no_polygon});
    arrivals.push_back(arrival);
  }
  Spectrum sum = Spectrum::Zero(lighting.bands);
  if (exposed == 0) return sum;
  const Field transmittance = lighting.paths.transmittance(segments);
  for (std::size_t k = 0; k < arrivals.size(); ++k)
    sum += arrivals[k].irradiance * transmittance.row(static_cast<Eigen::Index>(k)) * *arrivals[k].colour;
  return sum / static_cast<double>(exposed);
}

Estimate Estimator::estimate(const Receiver& receiver, const Source& source, std::uint32_t key) const {
  const auto set = [&](std::uint32_t k) { return std::span(points[(key + k * step) % scrambles]); };
  if (receiver.is_point && !source.has_extent)
    return {mean(receiver, source, set(0).first(1)), Spectrum::Zero(lighting.bands)};
  const std::size_t each = std::max<std::size_t>(1, source.samples / replicates);
  Spectrum sum = Spectrum::Zero(lighting.bands);
  Spectrum squares = sum;
  for (std::uint32_t k = 0; k < replicates; ++k) {
    const Spectrum one = mean(receiver, source, set(k).first(each));
    sum += one;
    squares += one.square();
  }
  const Spectrum mean_of_all = sum / replicates;
  const Spectrum spread = (squares / replicates - mean_of_all.square()).max(0.0);
  return {mean_of_all, spread / (replicates - 1)};
}

Estimate Estimator::total(const Receiver& receiver, std::uint64_t seed, std::uint64_t index) const {
  Estimate all{Spectrum::Zero(lighting.bands), Spectrum::Zero(lighting.bands)};
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const Estimate one = estimate(receiver, sources[k], hash({seed, index, k}));
    all.mean += one.mean;
    all.variance += one.variance;
  }
  return all;
}

DirectIrradiance at_receivers(const Estimator& estimator, const std::vector<Receiver>& receivers, std::uint64_t seed,
                              const Observer& observer) {
  const auto rows = static_cast<Eigen::Index>(receivers.size());
  DirectIrradiance direct{Field(rows, estimator.lighting.bands), Field(rows, estimator.lighting.bands)};
  parallel_for(receivers.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const Estimate estimate = estimator.total(receivers[k], seed, k);
    direct.irradiance.row(static_cast<Eigen::Index>(k)) = estimate.mean;
    direct.standard_error.row(static_cast<Eigen::Index>(k)) = estimate.variance.sqrt();
  });
  return direct;
}

}  // namespace

DirectIrradiance direct_irradiance(const Lighting& lighting, const PatchMesh& mesh, const LightingOptions& options,
                                   const Observer& observer) {
  std::vector<Receiver> receivers;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const auto place = [&mesh, i](double u, double v) {
      return SurfacePoint{square_to_quad(mesh.corner_points(i).points, u, v), mesh.normal[i], mesh.polygon[i]};
    };
    receivers.push_back({place, false, mesh.side[i]});
  }
  return at_receivers(estimator_for(lighting, options), receivers, options.seed, observer);
}

DirectIrradiance direct_irradiance(const Lighting& lighting, std::span<const SurfacePoint> points,
                                   const LightingOptions& options, const Observer& observer) {
  std::vector<Receiver> receivers;
  for (const SurfacePoint& point : points) {
    receivers.push_back({[&point](double, double) { return point; }, true, Side::front});
  }
  return at_receivers(estimator_for(lighting, options), receivers, options.seed, observer);
}

}  // namespace patchlight
