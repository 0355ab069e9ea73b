#include "lighting/direct_irradiance.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "lighting/luminaire_irradiance.h"
#include "lighting/receivers.h"
#include "lighting/shades.h"
#include "lighting/shifted_points.h"
#include "lighting/sky_irradiance.h"
#include "mesh/means_around.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {
namespace {

// Independent estimates of each irradiance: their spread is its standard error. That of four is often small by chance:
// patches take the mean of those around, which points do not have.
constexpr std::uint32_t replicates = 4;
constexpr std::uint32_t replicates_at_points = 16;

// Scrambles of the Sobol points that receivers and sources choose from, each shifted anew; odd steps lead through all.
constexpr std::uint32_t scrambles = 64;
constexpr std::uint32_t step = 17;

// Times the usual number of rays to sun and luminaires where their shadows are too many to be found by geometry, and to
// balls at points.
constexpr int sun_effort = 64;
constexpr int lamp_effort = 4;

// Of a share that n rays all find to be 0, or all to be 1, no more than this over n is missed in 95 of 100 cases.
// Hanley and Lippman-Hand 1983, the rule of three.
constexpr double rule_of_three = 3;

// The points of one estimate: for rays, shifted for this receiver and source alone, and those that find the share of a
// patch that is not covered.
struct Samples {
  SamplePoints rays;
  SamplePoints places;
};

// Estimates of the mean irradiance of one receiver, with or without shadows.
using MeanBy = std::function<Spectrum(const Samples&, bool)>;

// Something that gives light.
struct Source {
  std::function<MeanBy(const Receiver&)> mean_at;
  std::uint32_t samples = 0;
  bool has_extent = false;
  int effort = 1;  // times the samples where rays have to find the shadows of a light without extent, or at a point
  std::function<std::optional<LeftByShadows>(const Receiver&)> left = {};  // on a patch, without extent
  std::function<Spectrum(const Receiver&)> unshadowed = {};                // in the middle, without extent
  std::function<bool(const Receiver&)> may_be_hidden = {};                 // with extent
};

template <class Mean>
std::function<MeanBy(const Receiver&)> at_each(Mean mean) {
  return [mean](const Receiver& receiver) {
    return [mean, &receiver](const Samples& samples, bool in_shadow) { return mean(receiver, samples, in_shadow); };
  };
}

using ArrivalAt = std::function<Arrival(const SurfacePoint&, const Eigen::Vector2d&)>;

// Of light that comes from one direction for each sample. Places over which another polygon lies do not count.
Spectrum mean_of_arrivals(const Lighting& lighting, const ArrivalAt& arrival_at, const Receiver& receiver,
                          SamplePoints samples, bool in_shadow) {
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
  const Field transmittance = in_shadow
                                  ? lighting.paths.transmittance(segments)
                                  : Field(Field::Ones(static_cast<Eigen::Index>(segments.size()), lighting.bands));
  for (std::size_t k = 0; k < arrivals.size(); ++k)
    sum += arrivals[k].irradiance * transmittance.row(static_cast<Eigen::Index>(k)) * *arrivals[k].colour;
  return sum / static_cast<double>(exposed);
}

Source source_of(const Lighting& lighting, const Luminaire& luminaire, std::uint32_t samples) {
  const ArrivalAt arrival_at = [&lighting, &luminaire](const SurfacePoint& at, const Eigen::Vector2d& uv) {
    return from_luminaire(luminaire, lighting.up, at, uv);
  };
  const bool has_extent = std::holds_alternative<SphericalLamp>(luminaire.light);
  const auto mean = [&lighting, &luminaire, arrival_at, has_extent](const Receiver& receiver, const Samples& samples_at,
                                                                    bool in_shadow) {
    if (has_extent || receiver.is_point())
      return mean_of_arrivals(lighting, arrival_at, receiver, samples_at.rays, in_shadow);
    return luminaire_irradiance(lighting, luminaire, receiver, {samples_at.rays, samples_at.places}, in_shadow);
  };
  if (const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light)) {
    const auto may_be_hidden = [&lighting, &luminaire, radius = sphere->radius](const Receiver& receiver) {
      const SurfacePoint middle = receiver.place(0.5, 0.5);
      const std::vector<Point> places = receiver.is_point() ? std::vector<Point>{middle.point} : receiver.corners;
      return lighting.paths.may_be_hidden(places, middle.normal, luminaire.position, radius);
    };
    return {.mean_at = at_each(mean),
            .samples = samples,
            .has_extent = true,
            .effort = lamp_effort,
            .may_be_hidden = may_be_hidden};
  }
  const auto left = [&](const Receiver& receiver) { return left_by_shadows(lighting, luminaire, receiver); };
  const auto unshadowed = [&lighting, arrival_at](const Receiver& receiver) {
    const Arrival arrival = arrival_at(receiver.place(0.5, 0.5), {0.5, 0.5});
    if (!(arrival.irradiance > 0)) return Spectrum(Spectrum::Zero(lighting.bands));
    return Spectrum(arrival.irradiance * *arrival.colour);
  };
  return {at_each(mean), samples, false, lamp_effort, left, unshadowed};
}

Source sun_of(const Lighting& lighting, std::uint32_t samples) {
  const auto unshadowed = [&lighting](const Receiver& receiver) {
    const Arrival arrival = from_sun(lighting, receiver.place(0.5, 0.5));
    return Spectrum(arrival.irradiance * lighting.sun->normal_irradiance);
  };
  const auto mean = [&lighting, unshadowed](const Receiver& receiver, const Samples& samples_at, bool in_shadow) {
    if (!in_shadow) return unshadowed(receiver);
    const auto arrival_at = [&](const SurfacePoint& at, const Eigen::Vector2d&) { return from_sun(lighting, at); };
    return mean_of_arrivals(lighting, arrival_at, receiver, samples_at.rays, true);
  };
  const auto left = [&lighting](const Receiver& receiver) -> std::optional<LeftByShadows> {
    const auto share = lighting.shades->transmittance(receiver, {lighting.sun->direction, 0});
    if (!share) return std::nullopt;
    return LeftByShadows{*share, Spectrum::Zero(lighting.bands)};
  };
  return {at_each(mean), samples, false, sun_effort, left, unshadowed};
}

std::vector<Source> sources_of(const Lighting& lighting, const LightingOptions& options) {
  std::vector<Source> sources;
  for (const Luminaire& luminaire : lighting.luminaires)
    sources.push_back(source_of(lighting, luminaire, static_cast<std::uint32_t>(options.lamp_samples)));
  if (lighting.sun) sources.push_back(sun_of(lighting, static_cast<std::uint32_t>(options.sun_samples)));
  if (lighting.sky) {
    const auto mean_at = [&lighting](const Receiver& receiver) {
      return [&lighting, &receiver, aim = sky_aim(lighting, receiver)](const Samples& samples, bool) {
        return sky_irradiance(lighting, receiver, aim, samples.rays);
      };
    };
    sources.push_back({mean_at, static_cast<std::uint32_t>(options.sky_samples), true});
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

  Field replicates_by(const Source& source, const Receiver& receiver, std::uint32_t key, std::size_t each,
                      bool in_shadow) const;  // one row each
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

// What n rays that all let the same share through may have missed, squared: of what arrives without shadows. One row
// for each replicate.
Spectrum missed_variance(const Field& arriving, const Field& unshadowed, std::size_t n) {
  const Spectrum all = unshadowed.colwise().mean();
  const Field share = (unshadowed > 0).select(arriving / unshadowed, 0.0);
  const bool agree = (share.colwise().maxCoeff() - share.colwise().minCoeff() <= 1e-12).all();
  return agree ? Spectrum((rule_of_three / static_cast<double>(n) * all).square()) : Spectrum(0 * all);
}

Estimate estimate_of(const Field& replicates_of) {
  const auto count = static_cast<double>(replicates_of.rows());
  const Spectrum mean = replicates_of.colwise().mean();
  const Spectrum squares = replicates_of.square().colwise().mean();
  return {mean, (squares - mean.square()).max(0.0) / (count - 1)};
}

Field Estimator::replicates_by(const Source& source, const Receiver& receiver, std::uint32_t key, std::size_t each,
                               bool in_shadow) const {
  const std::uint32_t sets = receiver.is_point() ? replicates_at_points : replicates;
  const MeanBy mean = source.mean_at(receiver);
  Field found(sets, bands);
  for (std::uint32_t k = 0; k < sets; ++k) {
    const SamplePoints set = points[(key + k * step) % scrambles];
    found.row(k) = mean({shifted(set.first(each), hash({key, k})), set}, in_shadow);
  }
  return found;
}

Estimate Estimator::by_one(const Source& source, const Receiver& receiver, std::uint32_t key) const {
  const Spectrum none = Spectrum::Zero(bands);
  const bool is_point = receiver.is_point();
  if (is_point && !source.has_extent) {
    const SamplePoints one = SamplePoints(points[0]).first(1);
    return {source.mean_at(receiver)({one, one}, true), none};
  }
  const auto left = source.left && !is_point ? source.left(receiver) : std::nullopt;
  if (left && (left->share == 0).all()) return {none, none};

  const bool in_shadow = source.may_be_hidden ? source.may_be_hidden(receiver) : !left;
  const bool more = source.has_extent ? is_point : !left;
  const std::size_t each = std::max<std::size_t>(1, (more ? source.effort : 1) * source.samples / replicates);
  const Field arriving = replicates_by(source, receiver, key, each, in_shadow);
  Estimate found = estimate_of(arriving);
  if (left)
    return {found.mean * left->share,
            found.variance * left->share.square() + (found.mean * left->standard_error).square()};
  const auto rays = each * static_cast<std::size_t>(arriving.rows());
  if (source.unshadowed) {
    const Field unshadowed = source.unshadowed(receiver).replicate(arriving.rows(), 1);
    found.variance = found.variance.max(missed_variance(arriving, unshadowed, rays));
  } else if (in_shadow && is_point && source.may_be_hidden) {
    const Field unshadowed = replicates_by(source, receiver, key, each, false);
    found.variance = found.variance.max(missed_variance(arriving, unshadowed, rays));
  }
  return found;
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

void add(DirectIrradiance& direct, const DirectIrradiance& more) {
  direct.irradiance += more.irradiance;
  direct.standard_error = (direct.standard_error.square() + more.standard_error.square()).sqrt();
}

DirectIrradiance direct_irradiance(const Lighting& lighting, const PatchMesh& mesh, const LightingOptions& options,
                                   const Observer& observer) {
  return at_receivers(estimator_for(lighting, options), receivers_of(mesh), options.seed, observer);
}

Field with_errors_around(const PatchMesh& mesh, const Field& standard_error) {
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), standard_error.rows());
  return standard_error.max(means_around(mesh, area, standard_error));
}

DirectIrradiance direct_irradiance(const Lighting& lighting, std::span<const SurfacePoint> points,
                                   const LightingOptions& options, const Observer& observer) {
  return at_receivers(estimator_for(lighting, options), receivers_of(points), options.seed, observer);
}

}  // namespace patchlight
