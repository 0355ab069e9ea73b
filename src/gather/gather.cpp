#include "patchlight/gather/gather.h"

#include "patchlight/base/parallel.h"

#include "gather/sources.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

// A sensor that is nearer to a polygon's plane lies on it, as a share of the scene's extent: the occluder's own limit.
constexpr double on_plane_tolerance = 1e-9;

// Irradiance at one sensor.
struct Reading {
  Spectrum mean;
  Spectrum variance;  // of the mean
};

// E = sum_j F(x, j) V_j B_j, and its variance sum_j (F(x, j) B_j)^2 var V_j. Rays to a patch that agree may miss what
// the others of it would meet: of all such rays the heaviest counts as an error.
Reading reading_of(std::span<const Source> sources, std::span<const VisibleShare> shares, const FieldView& radiosity) {
  Reading reading{Spectrum::Zero(radiosity.cols()), Spectrum::Zero(radiosity.cols())};
  Spectrum heaviest = reading.mean;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const Spectrum unoccluded = sources[s].form_factor * radiosity.row(sources[s].patch);
    reading.mean += unoccluded * shares[s].mean;
    reading.variance += unoccluded.square() * shares[s].variance;
    if (!(shares[s].variance > 0)) heaviest = heaviest.max(unoccluded / shares[s].rays);
  }
  reading.variance += heaviest.square();
  return reading;
}

std::vector<RayCounts> counts_for(std::span<const Source> sources, double rays, double least) {
  double form_factors = 0;
  for (const Source& source : sources) form_factors += source.form_factor;
  std::vector<RayCounts> counts;
  // Half of them by light, half by form factor: a lamp that is hidden does not take all rays.
  for (const Source& source : sources)
    counts.push_back(ray_counts(least + rays * (source.light_share + source.form_factor / form_factors) / 2));
  return counts;
}

// Both by the number of their rays.
std::vector<VisibleShare> together(std::vector<VisibleShare> first, std::span<const VisibleShare> second) {
  for (std::size_t s = 0; s < first.size(); ++s) {
    const double rays = first[s].rays + second[s].rays;
    const double a = first[s].rays / rays;
    const double b = second[s].rays / rays;
    first[s] = {a * first[s].mean + b * second[s].mean, a * a * first[s].variance + b * b * second[s].variance, rays};
  }
  return first;
}

// How many times as many rays would leave the wanted error; 1 where nothing is seen.
double wanted_factor(const Reading& reading, const GatherOptions& options) {
  const Spectrum allowed = (options.wanted_error * reading.mean).square();
  const Spectrum factor = (reading.mean > 0).select(reading.variance / allowed, 1.0);
  return std::max(1.0, factor.maxCoeff());
}

Reading read_sensor(const Sensor& sensor, std::span<const Source> sources, const FieldView& radiosity,
                    const ShadowRays& rays, const GatherOptions& options) {
  const std::vector<RayCounts> first = counts_for(sources, options.rays, options.least_rays);
  std::vector<VisibleShare> shares = rays.visible_shares(sensor, sources, first, 0);
  const Reading reading = reading_of(sources, shares, radiosity);
  double traced = 0;
  for (const VisibleShare& share : shares) traced += share.rays;
  const double more = std::min((wanted_factor(reading, options) - 1) * traced, options.most_rays - traced);
  if (!(more > traced / 2)) return reading;
  const double share = more / traced;
  const std::vector<RayCounts> second = counts_for(sources, share * options.rays, share * options.least_rays);
  shares = together(std::move(shares), rays.visible_shares(sensor, sources, second, 1));
  return reading_of(sources, shares, radiosity);
}

}  // namespace

GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const Occluder& occluder,
                                     std::span<const Sensor> sensors, const GatherOptions& options,
                                     const Observer& observer) {
  const ShadowRays rays(mesh, occluder, options.seed);
  const double tolerance = on_plane_tolerance / occluder.frame().scale;
  const Field zero = Field::Zero(static_cast<Eigen::Index>(sensors.size()), radiosity.cols());
  GatheredIrradiance result{zero, zero};
  parallel_for(sensors.size(), Stage::gather, observer, [&](std::size_t k) {
    const std::vector<Source> sources = sources_before(sensors[k], mesh, radiosity, tolerance);
    const Reading reading = read_sensor(sensors[k], sources, radiosity, rays, options);
    result.irradiance.row(static_cast<Eigen::Index>(k)) = reading.mean;
    result.standard_error.row(static_cast<Eigen::Index>(k)) = reading.variance.sqrt();
  });
  return result;
}

}  // namespace patchlight
