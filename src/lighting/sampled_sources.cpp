#include "lighting/sampled_sources.h"

#include "form_factor/point_polygon.h"
#include "lighting/shades.h"
#include "lighting/sky_irradiance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace patchlight {
namespace {

// Nearer to the plane of a patch, relative to its corners' distance, a luminaire counts as in the plane.
constexpr double luminaire_in_plane = 1e-9;

bool is_before(const Point& luminaire, const Receiver& receiver, const Vector& normal) {
  double height = 0;
  double distance = 0;
  for (const Point& corner : receiver.corners) {
    height = std::max(height, normal.dot(luminaire - corner));
    distance = std::max(distance, (luminaire - corner).norm());
  }
  return height > luminaire_in_plane * distance;
}

double exposed_share(const Lighting& lighting, const Receiver& receiver, SamplePoints places) {
  const PolygonIndex polygon = receiver.place(0.5, 0.5).polygon;
  if (!lighting.paths.is_covered_in_part(polygon, receiver.side)) return 1;
  std::size_t exposed = 0;
  for (const auto& [u, v, s, t] : places) exposed += is_covered(lighting, receiver, receiver.place(u, v)) ? 0 : 1;
  return static_cast<double>(exposed) / static_cast<double>(places.size());
}

// What the luminaire sees of the patch.
struct SeenPatch {
  double solid_angle = 0;
  double weights = 0;  // of all points, those under other polygons as well
  std::vector<Segment> segments;
  std::vector<double> intensities;  // times the points' weights
  const Spectrum* colour = nullptr;
};

SeenPatch seen_patch(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                     SamplePoints rays) {
  SurfacePoint at = receiver.place(0.5, 0.5);
  SeenPatch seen;
  if (!is_before(luminaire.position, receiver, at.normal)) return seen;
  for (const auto& [u, v, s, t] : rays) {
    const SeenPoint sample = sample_seen_point(luminaire.position, receiver.corners, u, v);
    if (!(sample.solid_angle > 0)) return {};
    seen.solid_angle = sample.solid_angle;
    seen.weights += sample.weight;
    at.point = sample.point;
    if (is_covered(lighting, receiver, at)) continue;
    const Arrival arrival = from_luminaire(luminaire, lighting.up, at, {s, t});
    if (!(arrival.irradiance > 0)) continue;
    // I = E d^2 / cos theta
    const Vector way = arrival.from - at.point;
    const double square = way.squaredNorm();
    const double intensity = arrival.irradiance * square * std::sqrt(square) / at.normal.dot(way);
    seen.segments.push_back({at.point, arrival.from, at.polygon, no_polygon});
    seen.intensities.push_back(sample.weight * intensity);
    seen.colour = arrival.colour;
  }
  return seen;
}

// The irradiance without shadows on a part of a patch, for a colour of 1.
struct Kernel {
  double mean = 0;     // by its middle and its corners, right up to the third order
  double error = 0;    // of the mean: what the corners have changed
  double scatter = 0;  // in the part, as of what is evenly distributed between the extremes
};

Kernel kernel_of(const Lighting& lighting, const Luminaire& luminaire, const std::array<Point, 4>& corners,
                 const Vector& normal) {
  const auto at = [&](const Point& point) {
    return from_luminaire(luminaire, lighting.up, {point, normal, no_polygon}, {0.5, 0.5}).irradiance;
  };
  const double middle = at((corners[0] + corners[1] + corners[2] + corners[3]) / 4);
  double lowest = middle, highest = middle, sum = 0;
  for (const Point& corner : corners) {
    const double E = at(corner);
    lowest = std::min(lowest, E);
    highest = std::max(highest, E);
    sum += E;
  }
  const double mean = (2 * middle + sum / 4) / 3;
  return {mean, std::abs(mean - middle), (highest - lowest) / std::sqrt(12.0)};
}

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

Spectrum luminaire_irradiance(const Lighting& lighting, const Luminaire& luminaire, const Receiver& receiver,
                              const ReceiverSamples& samples, bool in_shadow) {
  Spectrum sum = Spectrum::Zero(lighting.bands);
  const SeenPatch seen = seen_patch(lighting, luminaire, receiver, samples.rays);
  if (seen.segments.empty()) return sum;
  const double share = exposed_share(lighting, receiver, samples.places);
  if (!(share > 0)) return sum;
  if (in_shadow) {
    const Field transmittance = lighting.paths.transmittance(seen.segments);
    for (std::size_t k = 0; k < seen.intensities.size(); ++k)
      sum += seen.intensities[k] * transmittance.row(static_cast<Eigen::Index>(k)) * *seen.colour;
  } else {
    for (const double intensity : seen.intensities) sum += intensity * *seen.colour;
  }
  // E = 1 / A times the integral of I tau over the solid angle; the weights' mean, which is 1, is divided by because
  // what both vary by cancels.
  return sum * (seen.solid_angle / (seen.weights * share * area_vector(receiver.corners).norm()));
}

std::optional<LeftByShadows> left_by_shadows(const Lighting& lighting, const Luminaire& luminaire,
                                             const Receiver& receiver) {
  const LightPlace light{luminaire.position, 1};
  const Spectrum none = Spectrum::Zero(lighting.bands);
  const auto whole = lighting.shades->transmittance(receiver, light);
  if (!whole) return std::nullopt;
  if ((*whole == 0).all() || (*whole == 1).all()) return LeftByShadows{*whole, none};

  // Each part by its mean irradiance without shadows.
  const auto parts = lighting.shades->lit_parts(receiver, light);
  if (!parts) return std::nullopt;
  const Vector normal = receiver.place(0.5, 0.5).normal;
  Spectrum lit = none;
  Spectrum error = none;
  double all = 0;
  for (const LitPart& part : *parts) {
    if (!(part.exposed > 0)) continue;
    const Kernel kernel = kernel_of(lighting, luminaire, part.corners, normal);
    all += part.exposed * kernel.mean;
    lit += part.lit * kernel.mean;
    error += part.uneven * kernel.scatter + part.lit * kernel.error + part.doubt * kernel.mean;
  }
  // A beam narrower than the parts falls between their points: it may be in the light or in the shadow.
  if (!(all > 0)) return LeftByShadows{*whole, whole->min(1 - *whole).max(0.0)};
  return LeftByShadows{lit / all, error / all};
}

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
