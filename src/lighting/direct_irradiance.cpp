#include "lighting/direct_irradiance.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "lighting/receivers.h"
#include "lighting/sampled_sources.h"
#include "lighting/shifted_points.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace patchlight {
namespace {

// Independent estimates of each irradiance; no more than there are samples. Their spread is its standard error. That of
// four is often small by chance: patches take the mean of those around, which points do not have.
constexpr std::uint32_t replicates = 4;
constexpr std::uint32_t replicates_at_points = 16;

// Scrambles of the Sobol points that receivers and sources choose from, each shifted anew; odd steps lead through all.
constexpr std::uint32_t scrambles = 64;
constexpr std::uint32_t step = 17;

// Of as many rays in all, the error of the light on all patches, in the norm of their areas, is least where each takes
// a number by the square root of its area, if it varies as much over each: Neyman's allocation (1934). Times a power of
// two, with at most this exponent.
constexpr int most_doublings = 2;

// And with this one where more are asked for.
constexpr int most_asked = 6;

// Whether so many rays to a ball can be blocked costs as much to find as they do.
constexpr std::size_t few_rays = 16;

// Of a share that n rays all find to be 0, or all to be 1, no more than this over n is missed in 95 of 100 cases.
// Hanley and Lippman-Hand 1983, the rule of three.
constexpr double rule_of_three = 3;

// Irradiance by one source or by all.
struct Estimate {
  Spectrum mean;
  Spectrum variance;  // of the mean
};

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
  Estimate by_one(const SampledSource& source, const Receiver& receiver, std::uint32_t key, double effort) const;
  // With `effort` times the samples.
  Estimate by_all(const Receiver& receiver, std::uint64_t seed, std::uint64_t index, double effort) const;
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
  if (replicates_of.rows() == 1) return {mean, mean.square()};
  const Spectrum squares = replicates_of.square().colwise().mean();
  return {mean, (squares - mean.square()).max(0.0) / (count - 1)};
}

// Of patches no more sets than samples.
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
    const SamplePoints set = points[(key + k * step) % scrambles];
    moved.push_back(shifted(set.first(sets.each), hash({key, k})));
    of_sets.push_back({moved.back(), set});
  }
  return source.means_at(receiver)(of_sets, in_shadow);
}

Estimate Estimator::by_one(const SampledSource& source, const Receiver& receiver, std::uint32_t key,
                           double effort) const {
  const Spectrum none = Spectrum::Zero(bands);
  const bool is_point = receiver.is_point();
  if (is_point && !source.has_extent) {
    const SamplePoints one = SamplePoints(points[0]).first(1);
    const ReceiverSamples samples{one, one};
    return {source.means_at(receiver)({&samples, 1}, true).of_sets.row(0), none};
  }
  const auto left = source.left && !is_point ? source.left(receiver) : std::nullopt;
  if (left && (left->share == 0).all()) return {none, none};

  const bool more = source.has_extent ? is_point : !left;
  const SampleSets sets = sets_of(effort * (more ? source.effort : 1) * source.samples, is_point);
  // Few rays are sooner traced than they are found to be free. At points what is free has no error.
  const bool is_worth_asking = source.may_be_hidden && (is_point || sets.samples() > few_rays);
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

Estimate Estimator::by_all(const Receiver& receiver, std::uint64_t seed, std::uint64_t index, double effort) const {
  Estimate all{Spectrum::Zero(bands), Spectrum::Zero(bands)};
  for (std::size_t k = 0; k < sources.size(); ++k) {
    const Estimate one = by_one(sources[k], receiver, hash({seed, index, k}), effort);
    all.mean += one.mean;
    all.variance += one.variance;
  }
  return all;
}

// `receiver_at` and `effort_at` give the receiver of each number up to `count`, and times how many samples it takes.
template <class ReceiverAt, class EffortAt>
DirectIrradiance at_receivers(const Estimator& estimator, std::size_t count, const ReceiverAt& receiver_at,
                              const EffortAt& effort_at, const LightingOptions& options, const Observer& observer) {
  const auto rows = static_cast<Eigen::Index>(count);
  DirectIrradiance direct{Field(rows, estimator.bands), Field(rows, estimator.bands)};
  parallel_for(count, Stage::direct_light, observer, [&](std::size_t k) {
    const Estimate estimate = estimator.by_all(receiver_at(k), options.seed, k / options.alike, effort_at(k));
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
  const auto patch = [&](std::size_t k) { return receiver_of(mesh, static_cast<PatchIndex>(k)); };
  const std::span<const std::uint8_t> more = options.doublings;
  const std::vector<double>& areas = options.areas.empty() ? mesh.area : options.areas;
  // Patches that take the same samples take as many.
  const auto area_of = [&](std::size_t k) {
    const auto first = areas.begin() + static_cast<std::ptrdiff_t>(k - k % options.alike);
    const auto end = first + std::min<std::ptrdiff_t>(options.alike, areas.end() - first);
    return std::accumulate(first, end, 0.0) / static_cast<double>(end - first);
  };
  const auto doublings = [&, usual = options.usual_area > 0 ? options.usual_area : mean_area(areas)](std::size_t k) {
    constexpr double most = most_doublings;
    const auto by_area = static_cast<int>(std::lround(std::clamp(std::log2(area_of(k) / usual) / 2, -most, most)));
    return more.empty() ? by_area : std::min(by_area + more[k], most_asked);
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
