#include "lighting/direct_irradiance.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/tolerances.h"
#include "form_factor/point_polygon.h"
#include "lighting/receiver.h"
#include "lighting/shades.h"
#include "lighting/sky_irradiance.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <variant>

namespace patchlight {
namespace {

// Means of irradiances of one receiver: one row for each set of samples, one column per band.
struct Means {
  Field of_sets;
  Spectrum missed = {};  // an allowance for the light that one ray more may find, W/m^2; empty: not known, or nothing
};

// The share that shadows leave of the light on a patch, per band.
struct LeftByShadows {
  Spectrum share;
  Spectrum standard_error;  // of the share, as each sixteenth of a patch counts with its mean irradiance
};

// A source of light that is no patch.
struct SampledSource {
  // The means at a receiver, with or without shadows.
  std::function<Means(const Receiver&, std::span<const ReceiverSamples>, bool in_shadow)> means_at;
  std::uint32_t samples = 0;  // LightingOptions
  bool has_extent = false;
  int effort = 1;  // times the samples where rays have to find the shadows of a light without extent, or at a point
  std::function<std::optional<LeftByShadows>(const Receiver&)> left = {};  // on a patch, without extent
  std::function<Spectrum(const Receiver&)> unshadowed = {};                // in the middle, without extent
  std::function<bool(const Receiver&)> may_be_hidden = {};                 // with extent
};

// Nearer to the plane of a patch, relative to its corners' distance, a luminaire counts as in the plane.
bool is_before(const Point& luminaire, const Receiver& receiver, const Vector& normal) {
  double height = 0;
  double distance = 0;
  for (const Point& corner : receiver.corners) {
    height = std::max(height, normal.dot(luminaire - corner));
    distance = std::max(distance, (luminaire - corner).norm());
  }
  return height > tolerance_of_shapes * distance;
}

double exposed_share(const Lighting& lighting, const Receiver& receiver, SamplePoints places) {
  const PolygonIndex polygon = receiver.place(0.5, 0.5).polygon;
  if (!lighting.paths.is_covered_in_part(polygon, receiver.side)) return 1;
  std::size_t exposed = 0;
  for (const auto& [u, v, s, t] : places) exposed += is_covered(lighting, receiver, receiver.place(u, v)) ? 0 : 1;
  return static_cast<double>(exposed) / static_cast<double>(places.size());
}

// The part of a patch that the luminaire sees.
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

// The irradiance without shadows on a part of a patch, for a color of 1.
struct Kernel {
  double mean = 0;     // by its middle and its corners, right up to the third order
  double error = 0;    // of the mean: what the corners have changed
  double scatter = 0;  // in the part, if it is evenly distributed between the extremes
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

// Mean irradiance of a patch by a luminaire without extent, over the part over which no other polygon lies. Points of
// the patch are chosen by the solid angle under which the luminaire sees it, so that without shadows an isotropic one
// leaves no variance however near it is.
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

// Found by the outlines of all shadows; nothing where they are too many (Shades).
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

using ArrivalAt = std::function<Arrival(const SurfacePoint&, const Eigen::Vector2d&)>;

// Means over the sets of light that comes from one direction for each sample. Places over which another polygon lies do
// not count. The shadow rays of all sets are traced together.
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
  constexpr int effort = 4;
  const ArrivalAt arrival_at = [&lighting, &luminaire](const SurfacePoint& at, const Eigen::Vector2d& uv) {
    return from_luminaire(luminaire, lighting.up, at, uv);
  };
  const auto means_at = [&lighting, &luminaire, arrival_at](
                            const Receiver& receiver, std::span<const ReceiverSamples> sets, bool in_shadow) -> Means {
    if (receiver.is_point() || std::holds_alternative<SphericalLamp>(luminaire.light))
      return {means_of_arrivals(lighting, arrival_at, receiver, sets, in_shadow)};
    Field means(static_cast<Eigen::Index>(sets.size()), lighting.bands);
    for (std::size_t k = 0; k < sets.size(); ++k)
      means.row(static_cast<Eigen::Index>(k)) = luminaire_irradiance(lighting, luminaire, receiver, sets[k], in_shadow);
    return {means};
  };
  if (const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light)) {
    const auto may_be_hidden = [&lighting, &luminaire, radius = sphere->radius](const Receiver& receiver) {
      const SurfacePoint middle = receiver.place(0.5, 0.5);
      const std::vector<Point> places = receiver.is_point() ? std::vector<Point>{middle.point} : receiver.corners;
      return lighting.paths.may_be_hidden(places, middle.normal, luminaire.position, radius);
    };
    return {
        .means_at = means_at, .samples = samples, .has_extent = true, .effort = effort, .may_be_hidden = may_be_hidden};
  }
  const auto left = [&](const Receiver& receiver) { return left_by_shadows(lighting, luminaire, receiver); };
  const auto unshadowed = [&lighting, arrival_at](const Receiver& receiver) {
    const Arrival arrival = arrival_at(receiver.place(0.5, 0.5), {0.5, 0.5});
    if (!(arrival.irradiance > 0)) return Spectrum(Spectrum::Zero(lighting.bands));
    return Spectrum(arrival.irradiance * *arrival.colour);
  };
  return {means_at, samples, false, effort, left, unshadowed};
}

SampledSource sun_of(const Lighting& lighting, std::uint32_t samples) {
  const auto unshadowed = [&lighting](const Receiver& receiver) {
    const Arrival arrival = from_sun(lighting, receiver.place(0.5, 0.5));
    return Spectrum(arrival.irradiance * lighting.sun->normal_irradiance);
  };
  const auto means_at = [&lighting, unshadowed](const Receiver& receiver, std::span<const ReceiverSamples> sets,
                                                bool in_shadow) -> Means {
    if (!in_shadow) return {unshadowed(receiver).replicate(static_cast<Eigen::Index>(sets.size()), 1)};
    const auto arrival_at = [&](const SurfacePoint& at, const Eigen::Vector2d&) { return from_sun(lighting, at); };
    return {means_of_arrivals(lighting, arrival_at, receiver, sets, true)};
  };
  const auto left = [&lighting](const Receiver& receiver) -> std::optional<LeftByShadows> {
    const auto share = lighting.shades->transmittance(receiver, {lighting.sun->direction, 0});
    if (!share) return std::nullopt;
    return LeftByShadows{*share, Spectrum::Zero(lighting.bands)};
  };
  return {.means_at = means_at, .samples = samples, .effort = 64, .left = left, .unshadowed = unshadowed};
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

std::vector<SampledSource> sampled_sources(const Lighting& lighting, const LightingOptions& options) {
  std::vector<SampledSource> sources;
  for (const Luminaire& luminaire : lighting.luminaires)
    sources.push_back(source_of(lighting, luminaire, static_cast<std::uint32_t>(options.lamp_samples)));
  if (lighting.sun) sources.push_back(sun_of(lighting, static_cast<std::uint32_t>(options.sun_samples)));
  if (lighting.sky) {
    const auto means_at = [&lighting](const Receiver& receiver, std::span<const ReceiverSamples> sets, bool) {
      return means_of_sky(lighting, receiver, sets);
    };
    sources.push_back({means_at, static_cast<std::uint32_t>(options.sky_samples), true});
  }
  return sources;
}

// Independent estimates of each irradiance; no more than there are samples. Their spread is its standard error. That of
// four is often small by chance: patches take the mean of those around, which points do not have.
constexpr std::uint32_t replicates = 4;
constexpr std::uint32_t replicates_at_points = 16;

// Scrambles of the Sobol points that receivers and sources choose from, each with shifts of its own.
constexpr std::uint32_t scrambles = 64;

struct SampleSets {
  std::uint32_t count = 1;
  std::size_t each = 1;

  std::size_t samples() const { return count * each; }
};

struct Estimator {
  Eigen::Index bands = 0;
  std::vector<SampledSource> sources;
  std::vector<std::vector<std::array<double, 4>>> points;  // per scramble

  // One row for each of so many sets.
  Means replicates_by(const SampledSource& source, const Receiver& receiver, std::uint32_t key, SampleSets sets,
                      bool in_shadow) const;
  // With `effort` times the samples.
  Estimate by_one(const SampledSource& source, const Receiver& receiver, std::uint32_t key, double effort) const;
};

// For receivers that take up to 2^doublings times the samples.
Estimator estimator_for(const Lighting& lighting, const LightingOptions& options, int doublings) {
  Estimator estimator{lighting.bands, sampled_sources(lighting, options), {}};
  std::uint32_t most = replicates;
  for (const SampledSource& source : estimator.sources)
    most = std::max(most, (static_cast<std::uint32_t>(source.effort) * source.samples) << doublings);
  const std::uint32_t count = most / replicates;
  for (std::uint32_t k = 0; k < scrambles; ++k)
    estimator.points.push_back(scrambled_sobol(count, hash({options.seed, k})));
  return estimator;
}

// The squared light that n rays may have missed, where all let the same share through: if all find 0, or all find 1,
// they miss no more than 3 / n in 95 of 100 cases (Hanley and Lippman-Hand 1983). One row for each replicate.
Spectrum missed_variance(const Field& arriving, const Field& unshadowed, std::size_t n) {
  const Spectrum all = unshadowed.colwise().mean();
  const Field share = (unshadowed > 0).select(arriving / unshadowed, 0.0);
  const bool agree = (share.colwise().maxCoeff() - share.colwise().minCoeff() <= tolerance_of_arithmetic).all();
  return agree ? Spectrum((3 / static_cast<double>(n) * all).square()) : Spectrum(0 * all);
}

// A patch has no more sets than samples.
SampleSets sets_of(double samples, bool at_point) {
  const auto most = static_cast<std::uint32_t>(std::clamp(samples, 1.0, static_cast<double>(replicates)));
  return {at_point ? replicates_at_points : most,
          static_cast<std::size_t>(std::max(1.0, samples / (at_point ? replicates : most)))};
}

Means Estimator::replicates_by(const SampledSource& source, const Receiver& receiver, std::uint32_t key,
                               SampleSets sets, bool in_shadow) const {
  std::vector<std::vector<std::array<double, 4>>> moved;
  std::vector<ReceiverSamples> of_sets;
  for (std::uint32_t k = 0; k < sets.count; ++k) {
    const SamplePoints set = points[(key + k * 17) % scrambles];  // odd steps lead through all
    moved.push_back(shifted(set.first(sets.each), hash({key, k})));
    of_sets.push_back({moved.back(), set});
  }
  return source.means_at(receiver, of_sets, in_shadow);
}

Estimate Estimator::by_one(const SampledSource& source, const Receiver& receiver, std::uint32_t key,
                           double effort) const {
  const Spectrum none = Spectrum::Zero(bands);
  const bool is_point = receiver.is_point();
  if (is_point && !source.has_extent) {
    const SamplePoints one = SamplePoints(points[0]).first(1);
    const ReceiverSamples samples{one, one};
    return {source.means_at(receiver, {&samples, 1}, true).of_sets.row(0), none};
  }
  const auto left = source.left && !is_point ? source.left(receiver) : std::nullopt;
  if (left && (left->share == 0).all()) return {none, none};

  const bool more = source.has_extent ? is_point : !left;
  const SampleSets sets = sets_of(effort * (more ? source.effort : 1) * source.samples, is_point);
  // Few rays cost less than the test for free sight. At points, light without shadows has no error.
  const bool is_worth_asking = source.may_be_hidden && (is_point || sets.samples() > 16);
  const bool in_shadow = is_worth_asking ? source.may_be_hidden(receiver) : !left;
  const auto [arriving, missed] = replicates_by(source, receiver, key, sets, in_shadow);
  Estimate found = estimate_of(arriving);
  if (missed.size() > 0) found.variance += missed.square();
  if (left)
    return {found.mean * left->share,
            found.variance * left->share.square() + (found.mean * left->standard_error).square()};
  if (source.unshadowed) {
    const Field unshadowed = source.unshadowed(receiver).replicate(arriving.rows(), 1);
    found.variance = found.variance.max(missed_variance(arriving, unshadowed, sets.samples()));
  } else if (in_shadow && is_point && source.may_be_hidden) {
    const Field unshadowed = replicates_by(source, receiver, key, sets, false).of_sets;
    found.variance = found.variance.max(missed_variance(arriving, unshadowed, sets.samples()));
  }
  return found;
}

// `receiver_at` and `effort_at` give the receiver of each number up to `count`, and times how many samples it takes.
template <class ReceiverAt, class EffortAt>
DirectIrradiance at_receivers(const Estimator& estimator, std::size_t count, const ReceiverAt& receiver_at,
                              const EffortAt& effort_at, const LightingOptions& options, const Observer& observer) {
  const auto rows = static_cast<Eigen::Index>(count);
  DirectIrradiance direct{Field(rows, estimator.bands), Field(rows, estimator.bands)};
  parallel_for(count, Stage::direct_light, observer, [&](std::size_t k) {
    const Receiver receiver = receiver_at(k);
    const double effort = effort_at(k);
    Spectrum mean = Spectrum::Zero(estimator.bands), variance = Spectrum::Zero(estimator.bands);
    for (std::size_t s = 0; s < estimator.sources.size(); ++s) {
      const std::uint32_t key = hash({options.seed, k / options.alike, s});
      const Estimate one = estimator.by_one(estimator.sources[s], receiver, key, effort);
      mean += one.mean;
      variance += one.variance;
    }
    direct.irradiance.row(static_cast<Eigen::Index>(k)) = mean;
    direct.standard_error.row(static_cast<Eigen::Index>(k)) = variance.sqrt();
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
  const auto patch = [&](std::size_t k) { return receiver_of(mesh, static_cast<PatchIndex>(k)); };
  const std::span<const std::uint8_t> more = options.doublings;
  const std::vector<double>& areas = options.areas.empty() ? mesh.area : options.areas;
  // If the light varies as much over each patch, the error of all in the norm of their areas is least where each takes
  // rays in proportion to the square root of its area: Neyman's allocation (1934). Here they take a power of two.
  // Patches with the same samples take as many.
  constexpr int most_doublings = 2;
  const auto area_of = [&](std::size_t k) {
    const auto first = areas.begin() + static_cast<std::ptrdiff_t>(k - k % options.alike);
    const auto end = first + std::min<std::ptrdiff_t>(options.alike, areas.end() - first);
    return std::accumulate(first, end, 0.0) / static_cast<double>(end - first);
  };
  const auto doublings = [&, usual = options.usual_area > 0 ? options.usual_area : mean_area(areas)](std::size_t k) {
    const double exponent = std::clamp<double>(std::log2(area_of(k) / usual) / 2, -most_doublings, most_doublings);
    const auto by_area = static_cast<int>(std::lround(exponent));
    return more.empty() ? by_area : std::min(by_area + more[k], 6);
  };
  int most = most_doublings;
  for (std::size_t k = 0; k < more.size(); ++k) most = std::max(most, doublings(k));
  const Estimator estimator = estimator_for(lighting, options, most);
  const auto effort = [&](std::size_t k) { return std::ldexp(1.0, doublings(k)); };
  return at_receivers(estimator, mesh.size(), patch, effort, options, observer);
}

Field with_errors_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const Field& standard_error,
                         std::span<const std::uint8_t> doublings) {
  if (doublings.empty()) return standard_error.max(means_around(mesh, area, standard_error));
  const Eigen::ArrayXd rays = multiples(doublings, standard_error.rows());
  const Field of_usual = standard_error.colwise() * rays.sqrt();
  return of_usual.max(means_around(mesh, area, of_usual)).colwise() / rays.sqrt();
}

DirectIrradiance direct_irradiance(const Lighting& lighting, std::span<const SurfacePoint> points,
                                   const LightingOptions& options, const Observer& observer) {
  const auto point = [&](std::size_t k) { return receiver_of(points[k]); };
  const auto effort = [](std::size_t) { return 1.0; };
  return at_receivers(estimator_for(lighting, options, 0), points.size(), point, effort, options, observer);
}

}  // namespace patchlight
