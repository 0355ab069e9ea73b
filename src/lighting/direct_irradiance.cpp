#include "lighting/direct_irradiance.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "lighting/luminaire_irradiance.h"
#include "lighting/receiver.h"
#include "lighting/shades.h"
#include "lighting/sky_irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {
namespace {

// Independent estimates of each irradiance: their spread is its standard error.
constexpr std::uint32_t replicates = 4;

// Scrambles of the Sobol points that patches and sources choose from; odd steps lead through all of them.
constexpr std::uint32_t scrambles = 64;
constexpr std::uint32_t step = 17;

// Times the usual number of rays to sun and luminaires where their shadows are too many to be found by geometry.
constexpr int sun_effort = 64;
constexpr int lamp_effort = 4;

// Of a share that n rays all find to be 0, or all to be 1, no more than this over n is missed in 95 of 100 cases.
// Hanley and Lippman-Hand 1983, the rule of three.
constexpr double rule_of_three = 3;

// Something that gives light: an estimate of the mean irradiance of a receiver, with or without shadows. It takes as
// many of a scramble's points as it is told for rays.
struct Source {
  std::function<Spectrum(const Receiver&, SamplePoints, std::size_t, bool)> mean;
  std::uint32_t samples = 0;
  bool has_extent = false;
  int effort = 1;  // times the samples where rays have to find the shadows of a light without extent
  std::function<std::optional<LeftByShadows>(const Receiver&)> left = {};  // on a patch, without extent
  std::function<Spectrum(const Receiver&)> unshadowed = {};                // in the middle, without extent
};

using ArrivalAt = std::function<Arrival(const SurfacePoint&, const Eigen::Vector2d&)>;

// Of light that comes from one direction for each sample. Places over which another polygon lies do not count.
Spectrum mean_of_arrivals(const Lighting& lighting, const ArrivalAt& arrival_at, const Receiver& receiver,
                          SamplePoints samples) {
  std::vector<Segment> segments;
  std::vector<Arrival> arrivals;
  std::size_t exposed = 0;
  for (const auto& [u, v, s, t] : samples) {
    const SurfacePoint at = receiver.place(u, v);
    if (is_covered(lighting, receiver, at)) continue;
    ++exposed;
    const Arrival arrival = arrival_at(at, {s, t});
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

Source source_of(const Lighting& lighting, const Luminaire& luminaire, std::uint32_t samples) {
  const ArrivalAt arrival_at = [&lighting, &luminaire](const SurfacePoint& at, const Eigen::Vector2d& uv) {
    return from_luminaire(luminaire, lighting.up, at, uv);
  };
  const bool has_extent = std::holds_alternative<SphericalLamp>(luminaire.light);
  const auto mean = [&lighting, &luminaire, arrival_at, has_extent](const Receiver& receiver, SamplePoints points,
                                                                    std::size_t rays, bool in_shadow) {
    if (has_extent || receiver.is_point()) return mean_of_arrivals(lighting, arrival_at, receiver, points.first(rays));
    return luminaire_irradiance(lighting, luminaire, receiver, {points.first(rays), points}, in_shadow);
  };
  if (has_extent) return {mean, samples, true};
  const auto left = [&](const Receiver& receiver) { return left_by_shadows(lighting, luminaire, receiver); };
  const auto unshadowed = [&lighting, arrival_at](const Receiver& receiver) {
    const Arrival arrival = arrival_at(receiver.place(0.5, 0.5), {0.5, 0.5});
    if (!(arrival.irradiance > 0)) return Spectrum(Spectrum::Zero(lighting.bands));
    return Spectrum(arrival.irradiance * *arrival.colour);
  };
  return {mean, samples, false, lamp_effort, left, unshadowed};
}

Source sun_of(const Lighting& lighting, std::uint32_t samples) {
  const auto unshadowed = [&lighting](const Receiver& receiver) {
    const Arrival arrival = from_sun(lighting, receiver.place(0.5, 0.5));
    return Spectrum(arrival.irradiance * lighting.sun->normal_irradiance);
  };
  const auto mean = [&lighting, unshadowed](const Receiver& receiver, SamplePoints points, std::size_t rays,
                                            bool in_shadow) {
    if (!in_shadow) return unshadowed(receiver);
    const auto arrival_at = [&](const SurfacePoint& at, const Eigen::Vector2d&) { return from_sun(lighting, at); };
    return mean_of_arrivals(lighting, arrival_at, receiver, points.first(rays));
  };
  const auto left = [&lighting](const Receiver& receiver) -> std::optional<LeftByShadows> {
    const auto share = lighting.shades->transmittance(receiver, {lighting.sun->direction, 0});
    if (!share) return std::nullopt;
    return LeftByShadows{*share, Spectrum::Zero(lighting.bands)};
  };
  return {mean, samples, false, sun_effort, left, unshadowed};
}

std::vector<Source> sources_of(const Lighting& lighting, const LightingOptions& options) {
  std::vector<Source> sources;
  for (const Luminaire& luminaire : lighting.luminaires)
    sources.push_back(source_of(lighting, luminaire, static_cast<std::uint32_t>(options.lamp_samples)));
  if (lighting.sun) sources.push_back(sun_of(lighting, static_cast<std::uint32_t>(options.sun_samples)));
  if (lighting.sky) {
    // With openings a sample takes two rays.
    const int rays = lighting.openings.empty() ? 1 : 2;
    const auto mean = [&lighting](const Receiver& receiver, SamplePoints points, std::size_t count, bool) {
      return sky_irradiance(lighting, receiver, points.first(count));
    };
    sources.push_back({mean, static_cast<std::uint32_t>(options.sky_samples / rays), true});
  }
  return sources;
}

// Irradiance by one source or by all.
struct Estimate {
  Spectrum mean;
  Spectrum variance;  // of the mean
};

struct Estimator {
  Eigen::Index bands = 0;
  std::vector<Source> sources;
  std::vector<std::vector<std::array<double, 4>>> points;  // per scramble

  Estimate by_one(const Source& source, const Receiver& receiver, std::uint32_t key) const;
  Estimate by_all(const Receiver& receiver, std::uint64_t seed, std::uint64_t index) const;
};

Estimator estimator_for(const Lighting& lighting, const LightingOptions& options) {
  const int to_sun = lighting.sun ? sun_effort * options.sun_samples : 0;
  const int to_lamps = lighting.luminaires.empty() ? 0 : lamp_effort * options.lamp_samples;
  const int most = std::max({to_lamps, to_sun, options.sky_samples});
  const auto count = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(most) / replicates);
  Estimator estimator{lighting.bands, sources_of(lighting, options), {}};
  for (std::uint32_t k = 0; k < scrambles; ++k)
    estimator.points.push_back(scrambled_sobol(count, hash({options.seed, k})));
  return estimator;
}

// What n rays that all find the same may have missed, squared.
Spectrum missed_variance(const Source& source, const Receiver& receiver, const Spectrum& mean, std::size_t n) {
  if (!source.unshadowed) return Spectrum::Zero(mean.size());
  const Spectrum most = source.unshadowed(receiver);
  const bool agree = (mean == 0).all() || ((mean - most).abs() <= 1e-12 * most).all();
  return agree ? Spectrum((rule_of_three / static_cast<double>(n) * most).square())
               : Spectrum(Spectrum::Zero(mean.size()));
}

Estimate Estimator::by_one(const Source& source, const Receiver& receiver, std::uint32_t key) const {
  const auto set = [&](std::uint32_t k) { return SamplePoints(points[(key + k * step) % scrambles]); };
  const Spectrum none = Spectrum::Zero(bands);
  if (receiver.is_point() && !source.has_extent) return {source.mean(receiver, set(0), 1, true), none};
  const auto left = source.left && !receiver.is_point() ? source.left(receiver) : std::nullopt;
  if (left && (left->share == 0).all()) return {none, none};

  const auto effort = static_cast<std::uint32_t>(left ? 1 : source.effort);
  const std::size_t each = std::max<std::size_t>(1, effort * source.samples / replicates);
  Spectrum sum = none;
  Spectrum squares = none;
  for (std::uint32_t k = 0; k < replicates; ++k) {
    const Spectrum one = source.mean(receiver, set(k), each, !left);
    sum += one;
    squares += one.square();
  }
  const Spectrum mean = sum / replicates;
  const Spectrum spread = (squares / replicates - mean.square()).max(0.0) / (replicates - 1);
  if (!left) return {mean, spread.max(missed_variance(source, receiver, mean, replicates * each))};
  return {mean * left->share, spread * left->share.square() + (mean * left->standard_error).square()};
}

Estimate Estimator::by_all(const Receiver& receiver, std::uint64_t seed, std::uint64_t index) const {
  Estimate all{Spectrum::Zero(bands), Spectrum::Zero(bands)};
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const Estimate one = by_one(sources[k], receiver, hash({seed, index, k}));
    all.mean += one.mean;
    all.variance += one.variance;
  }
  return all;
}

DirectIrradiance at_receivers(const Estimator& estimator, const std::vector<Receiver>& receivers, std::uint64_t seed,
                              const Observer& observer) {
  const auto rows = static_cast<Eigen::Index>(receivers.size());
  DirectIrradiance direct{Field(rows, estimator.bands), Field(rows, estimator.bands)};
  parallel_for(receivers.size(), Stage::direct_light, observer, [&](std::size_t k) {
    const Estimate estimate = estimator.by_all(receivers[k], seed, k);
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
    const PatchCorners corners = mesh.corner_points(i);
    receivers.push_back({place, mesh.side[i], {corners.points.begin(), corners.points.begin() + corners.count}});
  }
  return at_receivers(estimator_for(lighting, options), receivers, options.seed, observer);
}

DirectIrradiance direct_irradiance(const Lighting& lighting, std::span<const SurfacePoint> points,
                                   const LightingOptions& options, const Observer& observer) {
  std::vector<Receiver> receivers;
  for (const SurfacePoint& point : points) {
    receivers.push_back({[&point](double, double) { return point; }, Side::front, {}});
  }
  return at_receivers(estimator_for(lighting, options), receivers, options.seed, observer);
}

}  // namespace patchlight
