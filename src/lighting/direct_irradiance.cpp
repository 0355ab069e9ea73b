#include "lighting/direct_irradiance.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/tolerances.h"
#include "form_factor/point_polygon.h"
#include "lighting/irradiance_in_mirrors.h"
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

namespace patchlight {
namespace {

// The share that shadows leave of the light on a patch, per band.
struct LeftByShadows {
  Spectrum share;
  Spectrum standard_error;  // of the share, as each sixteenth of a patch counts with its mean irradiance
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
  const Spectrum* color = nullptr;
};

SeenPatch seen_patch(const Lighting& lighting, const LightSource& source, const Receiver& receiver, SamplePoints rays) {
  const Point& position = source.extent().ball.centre;
  SurfacePoint at = receiver.place(0.5, 0.5);
  SeenPatch seen;
  if (!is_before(position, receiver, at.normal)) return seen;
  for (const auto& [u, v, s, t] : rays) {
    const SeenPoint sample = sample_seen_point(position, receiver.corners, u, v);
    if (!(sample.solid_angle > 0)) return {};
    seen.solid_angle = sample.solid_angle;
    seen.weights += sample.weight;
    at.point = sample.point;
    if (is_covered(lighting, receiver, at)) continue;
    const LightSample arriving = source.sample(at, {s, t});
    if (!(arriving.irradiance > 0)) continue;
    // I = E d^2 / cos theta
    const Vector way = arriving.from - at.point;
    const double square = way.squaredNorm();
    const double intensity = arriving.irradiance * square * std::sqrt(square) / at.normal.dot(way);
    seen.segments.push_back(segment_to(arriving, at));
    seen.intensities.push_back(sample.weight * intensity);
    seen.color = arriving.color;
  }
  return seen;
}

// The irradiance without shadows on a part of a patch, for a color of 1.
struct Kernel {
  double mean = 0;     // by its middle and its corners, right up to the third order
  double error = 0;    // of the mean: what the corners have changed
  double scatter = 0;  // in the part, if it is evenly distributed between the extremes
};

Kernel kernel_of(const LightSource& source, const std::array<Point, 4>& corners, const Vector& normal) {
  const auto at = [&](const Point& point) { return source.sample({point, normal, no_polygon}, {0.5, 0.5}).irradiance; };
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
Spectrum luminaire_irradiance(const Lighting& lighting, const LightSource& source, const Receiver& receiver,
                              const ReceiverSamples& samples, bool in_shadow) {
  Spectrum sum = Spectrum::Zero(lighting.bands);
  const SeenPatch seen = seen_patch(lighting, source, receiver, samples.rays);
  if (seen.segments.empty()) return sum;
  const double share = exposed_share(lighting, receiver, samples.places);
  if (!(share > 0)) return sum;
  if (in_shadow) {
    const Field transmittance = lighting.paths.transmittance(seen.segments);
    for (std::size_t k = 0; k < seen.intensities.size(); ++k)
      sum += seen.intensities[k] * transmittance.row(static_cast<Eigen::Index>(k)) * *seen.color;
  } else {
    for (const double intensity : seen.intensities) sum += intensity * *seen.color;
  }
  // E = 1 / A times the integral of I tau over the solid angle; the weights' mean, which is 1, is divided by because
  // what both vary by cancels.
  return sum * (seen.solid_angle / (seen.weights * share * area_vector(receiver.corners).norm()));
}

// Found by the outlines of all shadows; nothing where they are too many (Shades).
std::optional<LeftByShadows> left_by_shadows(const Lighting& lighting, const LightSource& source,
                                             const Receiver& receiver) {
  const SourceExtent& extent = source.extent();
  const LightPlace light = extent.direction ? LightPlace{*extent.direction, 0} : LightPlace{extent.ball.centre, 1};
  const Spectrum none = Spectrum::Zero(lighting.bands);
  const auto whole = lighting.shades->transmittance(receiver, light);
  if (!whole) return std::nullopt;
  if (extent.direction || (*whole == 0).all() || (*whole == 1).all()) return LeftByShadows{*whole, none};

  // Each part by its mean irradiance without shadows.
  const auto parts = lighting.shades->lit_parts(receiver, light);
  if (!parts) return std::nullopt;
  const Vector normal = receiver.place(0.5, 0.5).normal;
  Spectrum lit = none;
  Spectrum error = none;
  double all = 0;
  for (const LitPart& part : *parts) {
    if (!(part.exposed > 0)) continue;
    const Kernel kernel = kernel_of(source, part.corners, normal);
    all += part.exposed * kernel.mean;
    lit += part.lit * kernel.mean;
    error += part.uneven * kernel.scatter + part.lit * kernel.error + part.doubt * kernel.mean;
  }
  // A beam narrower than the parts falls between their points: it may be in the light or in the shadow.
  if (!(all > 0)) return LeftByShadows{*whole, whole->min(1 - *whole).max(0.0)};
  return LeftByShadows{lit / all, error / all};
}

// Means over the sets of samples, each with one point of the source. Places over which another polygon lies do not
// count. The shadow rays of all sets are traced together.
Field means_of_samples(const Lighting& lighting, const LightSource& source, const Receiver& receiver,
                       std::span<const ReceiverSamples> sets, bool in_shadow) {
  struct OfSet {
    Eigen::Index set;
    LightSample sample;
  };
  std::vector<Segment> segments;
  std::vector<OfSet> arriving;
  std::vector<std::size_t> exposed(sets.size(), 0);
  for (std::size_t n = 0; n < sets.size(); ++n) {
    for (const auto& [u, v, s, t] : sets[n].rays) {
      const SurfacePoint at = receiver.place(u, v);
      if (is_covered(lighting, receiver, at)) continue;
      ++exposed[n];
      const LightSample sample = source.sample(at, {s, t});
      if (!(sample.irradiance > 0)) continue;
      segments.push_back(segment_to(sample, at));
      arriving.push_back({static_cast<Eigen::Index>(n), sample});
    }
  }
  Field means = Field::Zero(static_cast<Eigen::Index>(sets.size()), lighting.bands);
  if (segments.empty()) return means;
  const Field transmittance = in_shadow
                                  ? lighting.paths.transmittance(segments)
                                  : Field(Field::Ones(static_cast<Eigen::Index>(segments.size()), lighting.bands));
  for (std::size_t k = 0; k < arriving.size(); ++k) {
    const auto& [set, sample] = arriving[k];
    means.row(set) += sample.irradiance * transmittance.row(static_cast<Eigen::Index>(k)) * *sample.color;
  }
  for (std::size_t n = 0; n < sets.size(); ++n)
    means.row(static_cast<Eigen::Index>(n)) /= static_cast<double>(std::max<std::size_t>(1, exposed[n]));
  return means;
}

// The irradiance in the middle of a receiver, by one point of a source and without shadows.
Spectrum unshadowed_irradiance(const Lighting& lighting, const LightSource& source, const Receiver& receiver) {
  const LightSample sample = source.sample(receiver.place(0.5, 0.5), {0.5, 0.5});
  if (!(sample.irradiance > 0)) return Spectrum::Zero(lighting.bands);
  return sample.irradiance * *sample.color;
}

// Means over the sets of one source, with or without shadows.
Field means_of_source(const Lighting& lighting, const LightSource& source, const Receiver& receiver,
                      std::span<const ReceiverSamples> sets, bool in_shadow) {
  const bool is_sun = source.extent().direction.has_value();
  if (is_sun && !in_shadow)
    return unshadowed_irradiance(lighting, source, receiver).replicate(static_cast<Eigen::Index>(sets.size()), 1);
  if (!source.is_delta() || is_sun || receiver.is_point())
    return means_of_samples(lighting, source, receiver, sets, in_shadow);
  Field means(static_cast<Eigen::Index>(sets.size()), lighting.bands);
  for (std::size_t k = 0; k < sets.size(); ++k)
    means.row(static_cast<Eigen::Index>(k)) = luminaire_irradiance(lighting, source, receiver, sets[k], in_shadow);
  return means;
}

bool may_be_hidden(const Lighting& lighting, const LightSource& source, const Receiver& receiver) {
  const SurfacePoint middle = receiver.place(0.5, 0.5);
  const std::vector<Point> places = receiver.is_point() ? std::vector<Point>{middle.point} : receiver.corners;
  const Ball& ball = source.extent().ball;
  return lighting.paths.may_be_hidden(places, middle.normal, ball.centre, ball.radius);
}

// Independent estimates of each irradiance; no more than there are samples. Their spread is its standard error. That of
// four is often small by chance: patches take the mean of those around, which points do not have.
constexpr std::uint32_t replicates_on_patch = 4;
constexpr std::uint32_t replicates_at_points = 16;

// Scrambles of the Sobol points that receivers and sources choose from, each with shifts of its own.
constexpr std::uint32_t scrambles = 64;

struct SampleSets {
  std::uint32_t count = 1;
  std::size_t each = 1;

  std::size_t samples() const { return count * each; }
};

// Multiples of the samples: of a luminaire and the sun on a patch where rays have to find the shadows, of a sphere at a
// point, and of the sky at a point, which no neighbors average.
constexpr int effort_for_luminaires = 4;
constexpr int effort_for_sun = 64;
constexpr int effort_for_sky_at_point = 4;

struct Estimator {
  const LightSampler& lights;
  const LightingOptions& options;
  std::vector<std::vector<std::array<double, 4>>> points = {};  // per scramble

  const Lighting& lighting() const { return lights.lighting(); }
  SampleSets sets_of(const LightSource& source, const Receiver& receiver, double effort, bool more) const;
  // One row for each of so many sets. `means_of` returns those of all sets.
  template <class MeansOf>
  auto replicates(std::uint32_t key, SampleSets sets, const MeansOf& means_of) const;
  Field replicates_of(const LightSource& source, const Receiver& receiver, std::uint32_t key, SampleSets sets,
                      bool in_shadow) const;
  Estimate by_delta_source(const LightSource& source, const Receiver& receiver, std::uint32_t key, double effort) const;
  Estimate by_sphere(const LightSource& source, const Receiver& receiver, std::uint32_t key, double effort) const;
  Estimate by_sky(const Receiver& receiver, std::uint32_t key, double effort) const;
  Estimate at(const Receiver& receiver, std::uint64_t number, double effort) const;
};

// For receivers that take up to 2^doublings times the samples.
Estimator estimator_for(const LightSampler& lights, const LightingOptions& options, int doublings) {
  Estimator estimator{lights, options};
  const Lighting& lighting = lights.lighting();
  int most = 1;
  if (!lighting.luminaires.empty()) most = std::max(most, effort_for_luminaires * options.luminaire_samples);
  if (lighting.sun) most = std::max(most, effort_for_sun * options.sun_samples);
  if (lighting.sky) most = std::max(most, effort_for_sky_at_point * options.sky_samples);
  const std::uint32_t count = std::max(1U, (static_cast<std::uint32_t>(most) << doublings) / replicates_on_patch);
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
  const auto most = static_cast<std::uint32_t>(std::clamp(samples, 1.0, static_cast<double>(replicates_on_patch)));
  return {at_point ? replicates_at_points : most,
          static_cast<std::size_t>(std::max(1.0, samples / (at_point ? replicates_on_patch : most)))};
}

SampleSets Estimator::sets_of(const LightSource& source, const Receiver& receiver, double effort, bool more) const {
  const bool is_sun = source.extent().direction.has_value();
  const int samples = is_sun ? options.sun_samples : options.luminaire_samples;
  const int times = more ? (is_sun ? effort_for_sun : effort_for_luminaires) : 1;
  return patchlight::sets_of(effort * times * samples, receiver.is_point());
}

template <class MeansOf>
auto Estimator::replicates(std::uint32_t key, SampleSets sets, const MeansOf& means_of) const {
  std::vector<std::vector<std::array<double, 4>>> moved;
  std::vector<ReceiverSamples> of_sets;
  for (std::uint32_t k = 0; k < sets.count; ++k) {
    const SamplePoints set = points[(key + k * 17) % scrambles];  // odd steps lead through all
    moved.push_back(shifted(set.first(sets.each), hash({key, k})));
    of_sets.push_back({moved.back(), set});
  }
  return means_of(of_sets);
}

Field Estimator::replicates_of(const LightSource& source, const Receiver& receiver, std::uint32_t key, SampleSets sets,
                               bool in_shadow) const {
  return replicates(key, sets, [&](std::span<const ReceiverSamples> of_sets) {
    return means_of_source(lighting(), source, receiver, of_sets, in_shadow);
  });
}

// A source without extent. At a point one shadow ray finds all. On a patch its shadows are exact where Shades has them,
// and sampled elsewhere.
Estimate Estimator::by_delta_source(const LightSource& source, const Receiver& receiver, std::uint32_t key,
                                    double effort) const {
  const Spectrum none = Spectrum::Zero(lighting().bands);
  if (receiver.is_point()) {
    const SamplePoints one = SamplePoints(points[0]).first(1);
    const ReceiverSamples samples{one, one};
    return {means_of_samples(lighting(), source, receiver, {&samples, 1}, true).row(0), none};
  }
  const auto left = left_by_shadows(lighting(), source, receiver);
  if (left && (left->share == 0).all()) return {none, none};
  const SampleSets sets = sets_of(source, receiver, effort, !left);
  const Field arriving = replicates_of(source, receiver, key, sets, !left);
  Estimate found = estimate_of(arriving);
  if (left)
    return {found.mean * left->share,
            found.variance * left->share.square() + (found.mean * left->standard_error).square()};
  const Field unshadowed = unshadowed_irradiance(lighting(), source, receiver).replicate(arriving.rows(), 1);
  found.variance = found.variance.max(missed_variance(arriving, unshadowed, sets.samples()));
  return found;
}

Estimate Estimator::by_sphere(const LightSource& source, const Receiver& receiver, std::uint32_t key,
                              double effort) const {
  const SampleSets sets = sets_of(source, receiver, effort, receiver.is_point());
  // Few rays cost less than the test for free sight. At points, light without shadows has no error.
  const bool is_worth_asking = receiver.is_point() || sets.samples() > 16;
  const bool in_shadow = !is_worth_asking || may_be_hidden(lighting(), source, receiver);
  const Field arriving = replicates_of(source, receiver, key, sets, in_shadow);
  Estimate found = estimate_of(arriving);
  if (!in_shadow || !receiver.is_point()) return found;
  const Field unshadowed = replicates_of(source, receiver, key, sets, false);
  found.variance = found.variance.max(missed_variance(arriving, unshadowed, sets.samples()));
  return found;
}

Estimate Estimator::by_sky(const Receiver& receiver, std::uint32_t key, double effort) const {
  const bool is_point = receiver.is_point();
  const SkyAim aim = sky_aim(lighting(), receiver, is_point ? AimFor::points : AimFor::patch);
  const double samples = effort * (is_point ? effort_for_sky_at_point : 1) * options.sky_samples;
  const SampleSets sets = patchlight::sets_of(samples, is_point);
  const SkyLight light = replicates(key, sets, [&](std::span<const ReceiverSamples> of_sets) {
    std::vector<SamplePoints> rays;
    for (const ReceiverSamples& set : of_sets) rays.push_back(set.rays);
    return sky_irradiance(lighting(), receiver, aim, rays);
  });
  Estimate found = estimate_of(light.irradiance);
  if (is_point && light.seen.aimed > 0)
    found.variance += missed_sky(lighting(), receiver.place(0.5, 0.5), aim, light.seen).square();
  return found;
}

// The estimate by all sources. The number of the receiver selects its random numbers.
Estimate Estimator::at(const Receiver& receiver, std::uint64_t number, double effort) const {
  Estimate sum{Spectrum::Zero(lighting().bands), Spectrum::Zero(lighting().bands)};
  std::uint32_t source_number = 0;
  const auto add = [&](const auto& estimate_by) {
    const Estimate one = estimate_by(hash({options.seed, number, source_number++}));
    sum.mean += one.mean;
    sum.variance += one.variance;
  };
  for (const LightSource& source : lights.without_faces())
    add([&](std::uint32_t key) {
      return source.is_delta() ? by_delta_source(source, receiver, key, effort)
                               : by_sphere(source, receiver, key, effort);
    });
  if (lighting().sky) add([&](std::uint32_t key) { return by_sky(receiver, key, effort); });
  return sum;
}

// `receiver_at` and `effort_at` give the receiver of each number up to `count`, and times how many samples it takes.
template <class ReceiverAt, class EffortAt>
DirectIrradiance straight_irradiance(const Estimator& estimator, std::size_t count, const ReceiverAt& receiver_at,
                                     const EffortAt& effort_at, const Observer& observer) {
  const LightSampler& lights = estimator.lights;
  const Field none = Field::Zero(static_cast<Eigen::Index>(count), lights.lighting().bands);
  DirectIrradiance direct{none, none, none};
  if (lights.without_faces().empty() && !lights.lighting().sky) return direct;
  parallel_for(count, Stage::direct_light, observer, [&](std::size_t k) {
    const auto [mean, variance] = estimator.at(receiver_at(k), k / estimator.options.alike, effort_at(k));
    direct.irradiance.row(static_cast<Eigen::Index>(k)) = mean;
    direct.standard_error.row(static_cast<Eigen::Index>(k)) = variance.sqrt();
  });
  return direct;
}

// If the light varies as much over each patch, the error of all in the norm of their areas is least where each takes
// rays in proportion to the square root of its area: Neyman's allocation (1934). Here they take a power of two.
// Patches with the same samples take as many.
DirectIrradiance straight_irradiance(const LightSampler& lights, const PatchMesh& mesh, const LightingOptions& options,
                                     const Observer& observer) {
  const auto patch = [&](std::size_t k) { return receiver_of(mesh, static_cast<PatchIndex>(k)); };
  const std::span<const std::uint8_t> more = options.doublings;
  const std::vector<double>& areas = options.areas.empty() ? mesh.area : options.areas;
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
  const auto effort = [&](std::size_t k) { return std::ldexp(1.0, doublings(k)); };
  return straight_irradiance(estimator_for(lights, options, most), mesh.size(), patch, effort, observer);
}

DirectIrradiance straight_irradiance(const LightSampler& lights, std::span<const SurfacePoint> points,
                                     const LightingOptions& options, const Observer& observer) {
  const auto point = [&](std::size_t k) { return receiver_of(points[k]); };
  const auto effort = [](std::size_t) { return 1.0; };
  return straight_irradiance(estimator_for(lights, options, 0), points.size(), point, effort, observer);
}

template <class Receivers>
DirectIrradiance irradiance_of(const LightSampler& lights, const Receivers& receivers, const LightingOptions& options,
                               const Observer& observer) {
  const Field none = Field::Zero(static_cast<Eigen::Index>(receivers.size()), lights.lighting().bands);
  DirectIrradiance direct{none, none, none};
  if (!options.only_in_mirrors) direct = straight_irradiance(lights, receivers, options, observer);
  if (lights.lighting().mirrors) add(direct, irradiance_in_mirrors(lights, receivers, options, observer));
  return direct;
}

}  // namespace

void add(DirectIrradiance& direct, const DirectIrradiance& more) {
  direct.irradiance += more.irradiance;
  direct.standard_error = (direct.standard_error.square() + more.standard_error.square()).sqrt();
  direct.unfollowed += more.unfollowed;
}

DirectIrradiance direct_irradiance(const LightSampler& lights, const PatchMesh& mesh, const LightingOptions& options,
                                   const Observer& observer) {
  return irradiance_of(lights, mesh, options, observer);
}

DirectIrradiance direct_irradiance(const LightSampler& lights, std::span<const SurfacePoint> points,
                                   const LightingOptions& options, const Observer& observer) {
  return irradiance_of(lights, points, options, observer);
}

Field with_errors_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const Field& standard_error,
                         std::span<const std::uint8_t> doublings) {
  if (doublings.empty()) return standard_error.max(means_around(mesh, area, standard_error));
  const Eigen::ArrayXd rays = multiples(doublings, standard_error.rows());
  const Field of_usual = standard_error.colwise() * rays.sqrt();
  return of_usual.max(means_around(mesh, area, of_usual)).colwise() / rays.sqrt();
}

}  // namespace patchlight
