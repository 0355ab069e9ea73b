#include "patchlight/gather/gather.h"

#include "base/parallel.h"
#include "gather/slopes.h"
#include "gather/sources.h"
#include "mesh/longest_edge.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

// A sensor that is nearer to a polygon's plane lies on it, as a share of the scene's extent: the occluder's own limit.
constexpr double on_plane_tolerance = 1e-9;

// What is gathered, and how far that may be off.
struct Light {
  const PatchMesh& mesh;
  const FieldView& radiosity;
  const Slopes slopes;
  const RadiosityErrors& errors;
};

// Irradiance at one sensor.
struct Reading {
  Spectrum mean;
  Spectrum variance;     // of the mean, by the rays
  Spectrum sampling;     // variance by errors of the patches
  Spectrum mesh;         // by errors of the patches
  Spectrum solver;       // bound
  Spectrum unexplained;  // variance by what planes leave of the light on patches
  Spectrum hidden;       // by the ends of patches that are not visible
  Spectrum reflected;    // the part that patches have reflected
};

// What of each band gets through coloured panes.
Spectrum of_bands(const Spectrum& values, const VisibleShare& share) {
  return share.colour.size() > 0 ? Spectrum(values * share.colour) : values;
}

// E = sum_j F(x, j) (B_j V_j + g_j . m_j), V_j the visible share and m_j its first moment; and its variance. Rays to a
// patch that agree may miss what the others of it would meet: of all such rays the heaviest counts as an error.
Reading reading_of(std::span<const Source> sources, std::span<const VisibleShare> shares, const Light& light) {
  const Spectrum zero = Spectrum::Zero(light.radiosity.cols());
  Reading reading{zero, zero, zero, zero, zero, zero, zero, zero};
  Spectrum heaviest = zero;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const PatchIndex j = sources[s].patch;
    const double form_factor = sources[s].form_factor;
    const Spectrum colour = of_bands(Spectrum::Ones(zero.size()), shares[s]);
    for (Eigen::Index band = 0; band < zero.size(); ++band) {
      Eigen::Vector4d plane(light.radiosity(j, band), 0, 0, 0);
      if (light.slopes.gradient.size() > 0)
        plane.tail<3>() = light.slopes.gradient.row(j).segment(3 * band, 3).matrix().transpose();
      plane *= form_factor * colour[band];
      reading.mean[band] += plane.dot(shares[s].moments);
      reading.variance[band] += plane.dot(shares[s].covariance * plane);
    }
    if (!(shares[s].covariance(0, 0) > 0))
      heaviest = heaviest.max(form_factor * colour * light.radiosity.row(j) / shares[s].rays);
  }
  reading.variance += heaviest.square();
  return reading;
}

// How unevenly a sensor sees a patch, squared: e^2 / (e^2 + d^2), e its longest edge and d its distance. From afar all
// points of the patch count alike. Close by the nearest points alone count.
double squared_unevenness(const PatchMesh& mesh, PatchIndex j, const Point& from) {
  const double longest = longest_edge_squared(mesh.corner_points(j));
  return longest / (longest + (mesh.centroid[j] - from).squaredNorm());
}

// Let radiosity vary linearly with standard deviation sigma. Its mean over an end of share v differs from the patch's
// by sqrt(3) (1 - v) sigma. Sensors behind a grid see the same end of all its faces, so these errors add up.
Spectrum error_of_hidden_share(const Slopes& slopes, PatchIndex j, double visible) {
  const double hidden = std::max(0.0, 1 - visible);
  return hidden * slopes.residual.row(j).max(std::numbers::sqrt3 * slopes.unknown.row(j));
}

// The errors of the patches, as the sensor sees them.
Reading with_errors_of_patches(Reading reading, const Sensor& sensor, std::span<const Source> sources,
                               std::span<const VisibleShare> shares, const Light& light) {
  const auto& [sampling, correlated, mesh, solver, display, reflected] = light.errors;
  Field draws = Field::Zero(static_cast<Eigen::Index>(correlated.size()), reading.mean.size());
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const PatchIndex j = sources[s].patch;
    const double seen = sources[s].form_factor * shares[s].mean();
    if (!(seen > 0)) continue;
    const Spectrum weight = of_bands(Spectrum::Constant(reading.mean.size(), seen), shares[s]);
    if (sampling.size() > 0) reading.sampling += (weight * sampling.row(j)).square();
    for (Eigen::Index k = 0; k < draws.rows(); ++k)
      draws.row(k) += weight * correlated[static_cast<std::size_t>(k)].row(j);
    if (mesh.size() > 0) reading.mesh += weight * mesh.row(j);
    if (solver.size() > 0) reading.solver += weight * solver.row(j);
    if (reflected.size() > 0) reading.reflected += weight * reflected.row(j);
    if (light.slopes.residual.size() == 0) continue;
    // What is curved evenly has no first moment about the plane, so that it counts in the second order.
    const double squared = squared_unevenness(light.mesh, j, sensor.point);
    const Spectrum by_points =
        (squared * light.slopes.residual.row(j)).max(std::sqrt(squared) * light.slopes.unknown.row(j));
    reading.unexplained += (weight * by_points).square();
    reading.hidden += weight * error_of_hidden_share(light.slopes, j, shares[s].mean());
  }
  if (draws.rows() > 0) reading.sampling += draws.square().colwise().mean();
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
    const double mean = a * first[s].mean() + b * second[s].mean();
    Spectrum colour = a * first[s].mean() * first[s].colour + b * second[s].mean() * second[s].colour;
    if (mean > 0) colour /= mean;
    first[s] = {a * first[s].moments + b * second[s].moments,
                a * a * first[s].covariance + b * b * second[s].covariance, rays, colour};
  }
  return first;
}

// How many times as many rays would leave the wanted error: no number where nothing is seen yet of what may be seen.
double wanted_factor(const Reading& reading, const GatherOptions& options) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Spectrum allowed = (options.wanted_error * reading.mean).square();
  const Spectrum unseen = (reading.variance > 0).select(Spectrum::Constant(allowed.size(), infinity), 1.0);
  const Spectrum factor = (reading.mean > 0).select(reading.variance / allowed, unseen);
  return std::max(1.0, factor.maxCoeff());
}

Reading read_sensor(const Sensor& sensor, std::span<const Source> sources, const Light& light, const ShadowRays& rays,
                    const GatherOptions& options) {
  const std::vector<RayCounts> first = counts_for(sources, options.rays, options.least_rays);
  std::vector<VisibleShare> shares = rays.visible_shares(sensor, sources, first, 0);
  Reading reading = reading_of(sources, shares, light);
  double traced = 0;
  for (const VisibleShare& share : shares) traced += share.rays;
  const double more = std::min((wanted_factor(reading, options) - 1) * traced, options.most_rays - traced);
  if (more > traced / 2) {
    const double share = more / traced;
    const std::vector<RayCounts> second = counts_for(sources, share * options.rays, share * options.least_rays);
    shares = together(std::move(shares), rays.visible_shares(sensor, sources, second, 1));
    reading = reading_of(sources, shares, light);
  }
  return with_errors_of_patches(std::move(reading), sensor, sources, shares, light);
}

// A column for each band of what a reading has.
Field column_of(std::span<const Reading> readings, Spectrum Reading::*part, Eigen::Index bands) {
  Field all(static_cast<Eigen::Index>(readings.size()), bands);
  for (std::size_t k = 0; k < readings.size(); ++k) all.row(static_cast<Eigen::Index>(k)) = readings[k].*part;
  return all;
}

// What planes leave of the light on patches, and what patches of the same mesh may be off themselves.
Field mesh_part(std::span<const Reading> readings, const Field& irradiance, const RadiosityErrors& errors) {
  const Eigen::Index bands = irradiance.cols();
  const Field unexplained =
      column_of(readings, &Reading::unexplained, bands) + column_of(readings, &Reading::hidden, bands).square();
  if (errors.mesh.size() > 0) return (unexplained + column_of(readings, &Reading::mesh, bands).square()).sqrt();
  const Spectrum squares = irradiance.square().colwise().sum();
  const Spectrum share = (squares > 0).select(unexplained.colwise().sum() / squares, 0.0);
  return (unexplained + column_of(readings, &Reading::reflected, bands).square().rowwise() * share).sqrt();
}

}  // namespace

Field SensorErrors::total() const {
  return (rays.square() + sampling.square() + mesh.square() + solver.square()).sqrt();
}

GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const Occluder& occluder,
                                     std::span<const Sensor> sensors, const GatherOptions& options,
                                     const Observer& observer) {
  const ShadowRays rays(mesh, occluder, options.seed, options.coloured);
  const Light light{mesh, radiosity,
                    options.slopes ? slopes_of(mesh, radiosity, occluder, options.errors, observer) : Slopes{},
                    options.errors};
  const double tolerance = on_plane_tolerance / occluder.frame().scale;
  std::vector<Reading> readings(sensors.size());
  parallel_for(sensors.size(), Stage::gather, observer, [&](std::size_t k) {
    const std::vector<Source> sources = sources_before(sensors[k], mesh, radiosity, tolerance);
    readings[k] = read_sensor(sensors[k], sources, light, rays, options);
  });
  const Eigen::Index bands = radiosity.cols();
  const Field irradiance = column_of(readings, &Reading::mean, bands);
  return {irradiance,
          {.rays = column_of(readings, &Reading::variance, bands).sqrt(),
           .sampling = column_of(readings, &Reading::sampling, bands).sqrt(),
           .mesh = mesh_part(readings, irradiance, options.errors),
           .solver = column_of(readings, &Reading::solver, bands)}};
}

}  // namespace patchlight
