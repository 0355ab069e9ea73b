#include "lighting/sampled_sources.h"

#include "lighting/shades.h"
#include "lighting/sky_irradiance.h"

#include <algorithm>
#include <functional>

namespace patchlight {
namespace {

// Times the usual number of rays to sun and luminaires where their shadows are too many to be found by geometry, and to
// balls at points.
constexpr int sun_effort = 64;
constexpr int lamp_effort = 4;

template <class FieldBy>
std::function<MeansBy(const Receiver&)> at_each(FieldBy means) {
  return [means](const Receiver& receiver) {
    return [means, &receiver](std::span<const ReceiverSamples> sets, bool in_shadow) {
      return Means{means(receiver, sets, in_shadow)};
    };
  };
}

// One set after the other.
template <class Mean>
std::function<MeansBy(const Receiver&)> at_each_set(Eigen::Index bands, Mean mean) {
  return at_each([bands, mean](const Receiver& receiver, std::span<const ReceiverSamples> sets, bool in_shadow) {
    Field means(static_cast<Eigen::Index>(sets.size()), bands);
    for (std::size_t k = 0; k < sets.size(); ++k)
      means.row(static_cast<Eigen::Index>(k)) = mean(receiver, sets[k], in_shadow);
    return means;
  });
}

using ArrivalAt = std::function<Arrival(const SurfacePoint&, const Eigen::Vector2d&)>;

// Of light that comes from one direction for each sample. Places over which another polygon lies do not count. The
// shadow rays of all sets are traced together.
Field means_of_arrivals(const Lighting& lighting, const ArrivalAt& arrival_at, const Receiver& receiver,
                        std::span<const ReceiverSamples> sets, bool in_shadow) {
  struct OfSet {
    Eigen::Index set;
    Arrival arrival;
  };
  std::vector<Segment> segments;
  std::vector<OfSet> arrivals;
  std::vector<std::size_t> exposed(sets.size(), 0);
  for (std::size_t n = 0; n < sets.size(); ++n) {
    for (const auto& [u, v, s, t] : sets[n].rays) {
      const SurfacePoint at = receiver.place(u, v);
      if (is_covered(lighting, receiver, at)) continue;
      ++exposed[n];
      const Arrival arrival = arrival_at(at, {s, t});
      if (!(arrival.irradiance > 0)) continue;
      segments.push_back({at.point, arrival.from, at.polygon, no_polygon});
      arrivals.push_back({static_cast<Eigen::Index>(n), arrival});
    }
  }
  Field means = Field::Zero(static_cast<Eigen::Index>(sets.size()), lighting.bands);
  if (segments.empty()) return means;
  const Field transmittance = in_shadow
                                  ? lighting.paths.transmittance(segments)
                                  : Field(Field::Ones(static_cast<Eigen::Index>(segments.size()), lighting.bands));
  for (std::size_t k = 0; k < arrivals.size(); ++k) {
    const auto& [set, arrival] = arrivals[k];
    means.row(set) += arrival.irradiance * transmittance.row(static_cast<Eigen::Index>(k)) * *arrival.colour;
  }
  for (std::size_t n = 0; n < sets.size(); ++n)
    means.row(static_cast<Eigen::Index>(n)) /= static_cast<double>(std::max<std::size_t>(1, exposed[n]));
  return means;
}

SampledSource source_of(const Lighting& lighting, const Luminaire& luminaire, std::uint32_t samples) {
  const ArrivalAt arrival_at = [&lighting, &luminaire](const SurfacePoint& at, const Eigen::Vector2d& uv) {
    return from_luminaire(luminaire, lighting.up, at, uv);
  };
  const auto means = [&lighting, arrival_at](const Receiver& receiver, std::span<const ReceiverSamples> sets,
                                             bool in_shadow) {
    return means_of_arrivals(lighting, arrival_at, receiver, sets, in_shadow);
  };
  if (const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light)) {
    const auto may_be_hidden = [&lighting, &luminaire, radius = sphere->radius](const Receiver& receiver) {
      const SurfacePoint middle = receiver.place(0.5, 0.5);
      const std::vector<Point> places = receiver.is_point() ? std::vector<Point>{middle.point} : receiver.corners;
      return lighting.paths.may_be_hidden(places, middle.normal, luminaire.position, radius);
    };
    return {.means_at = at_each(means),
            .samples = samples,
            .has_extent = true,
            .effort = lamp_effort,
            .may_be_hidden = may_be_hidden};
  }
  const auto means_at = [&lighting, &luminaire, means](const Receiver& receiver) -> MeansBy {
    if (receiver.is_point()) return at_each(means)(receiver);
    return at_each_set(lighting.bands, [&](const Receiver& patch, const ReceiverSamples& samples_at, bool in_shadow) {
      return luminaire_irradiance(lighting, luminaire, patch, samples_at, in_shadow);
    })(receiver);
  };
  const auto left = [&](const Receiver& receiver) { return left_by_shadows(lighting, luminaire, receiver); };
  const auto unshadowed = [&lighting, arrival_at](const Receiver& receiver) {
    const Arrival arrival = arrival_at(receiver.place(0.5, 0.5), {0.5, 0.5});
    if (!(arrival.irradiance > 0)) return Spectrum(Spectrum::Zero(lighting.bands));
    return Spectrum(arrival.irradiance * *arrival.colour);
  };
  return {means_at, samples, false, lamp_effort, left, unshadowed};
}

Means means_of_sky(const Lighting& lighting, const Receiver& receiver, std::span<const ReceiverSamples> sets) {
  const SkyAim aim = sky_aim(lighting, receiver, receiver.is_point() ? AimFor::points : AimFor::patch);
  Field means(static_cast<Eigen::Index>(sets.size()), lighting.bands);
  SkySeen seen{std::vector<std::uint8_t>(aim.probabilities.size(), 0), 0};
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const SkyLight found = sky_irradiance(lighting, receiver, aim, sets[k].rays);
    means.row(static_cast<Eigen::Index>(k)) = found.irradiance;
    seen.aimed += found.seen.aimed;
    std::transform(seen.through.begin(), seen.through.end(), found.seen.through.begin(), seen.through.begin(),
                   std::bit_or<>());
  }
  if (!receiver.is_point() || seen.aimed == 0) return {means};
  return {means, missed_sky(lighting, receiver.place(0.5, 0.5), aim, seen)};
}

SampledSource sun_of(const Lighting& lighting, std::uint32_t samples) {
  const auto unshadowed = [&lighting](const Receiver& receiver) {
    const Arrival arrival = from_sun(lighting, receiver.place(0.5, 0.5));
    return Spectrum(arrival.irradiance * lighting.sun->normal_irradiance);
  };
  const auto means = [&lighting, unshadowed](const Receiver& receiver, std::span<const ReceiverSamples> sets,
                                             bool in_shadow) {
    if (!in_shadow) return Field(unshadowed(receiver).replicate(static_cast<Eigen::Index>(sets.size()), 1));
    const auto arrival_at = [&](const SurfacePoint& at, const Eigen::Vector2d&) { return from_sun(lighting, at); };
    return means_of_arrivals(lighting, arrival_at, receiver, sets, true);
  };
  const auto left = [&lighting](const Receiver& receiver) -> std::optional<LeftByShadows> {
    const auto share = lighting.shades->transmittance(receiver, {lighting.sun->direction, 0});
    if (!share) return std::nullopt;
    return LeftByShadows{*share, Spectrum::Zero(lighting.bands)};
  };
  return {at_each(means), samples, false, sun_effort, left, unshadowed};
}

}  // namespace

std::vector<SampledSource> sampled_sources(const Lighting& lighting, const LightingOptions& options) {
  std::vector<SampledSource> sources;
  for (const Luminaire& luminaire : lighting.luminaires)
    sources.push_back(source_of(lighting, luminaire, static_cast<std::uint32_t>(options.lamp_samples)));
  if (lighting.sun) sources.push_back(sun_of(lighting, static_cast<std::uint32_t>(options.sun_samples)));
  if (lighting.sky) {
    const auto means_at = [&lighting](const Receiver& receiver) {
      return [&lighting, &receiver](std::span<const ReceiverSamples> sets, bool) {
        return means_of_sky(lighting, receiver, sets);
      };
    };
    sources.push_back({means_at, static_cast<std::uint32_t>(options.sky_samples), true});
  }
  return sources;
}

}  // namespace patchlight
