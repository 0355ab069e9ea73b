#include "patchlight/gather/gather.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "gather/sources.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "visibility/occluder.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace patchlight {
namespace {

// How the radiosity of patches (rows) varies on them: the mean over each patch plus a plane.
struct Slopes {
  Field gradient;  // along the surface, W/m^2 per meter: three components of the first band, then those of the next
  Field residual;  // an allowance for how far the radiosity at a point is from the plane where it is curved, W/m^2
  Field unknown;   // root mean square of the part that the plane does not explain, W/m^2
};

using Gradient = Eigen::Matrix<double, 3, Eigen::Dynamic>;

// The variance of a linear function with this gradient over a patch: per triangle of its fan 1/12 of the sum over the
// corners of the squared differences from its mean, and that of its mean from the patch's.
double variance_over(const PatchMesh& mesh, PatchIndex j, const Vector& gradient) {
  const PatchCorners corners = mesh.corner_points(j);
  const std::span<const Point> points = corners;
  double variance = 0;
  double area = 0;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const std::array<Point, 3> triangle{points[0], points[k], points[k + 1]};
    const Point centroid = (triangle[0] + triangle[1] + triangle[2]) / 3;
    const double size = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).norm();
    double squares = std::pow(gradient.dot(centroid - mesh.centroid[j]), 2);
    for (const Point& corner : triangle) squares += std::pow(gradient.dot(corner - centroid), 2) / 12;
    variance += size * squares;
    area += size;
  }
  return area > 0 ? variance / area : 0;
}

class Planes {
 public:
  Planes(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder)
      : mesh_(mesh), values_(values), occluder_(occluder), at_vertex_(mesh) {}

  std::vector<PatchIndex> patches_around(PatchIndex j) const;
  Gradient fitted(PatchIndex j, std::span<const PatchIndex> around) const;
  Spectrum residual(PatchIndex j, std::span<const PatchIndex> around, const Gradient& gradient) const;

 private:
  bool are_about_equal(PatchIndex i, PatchIndex j) const;
  std::vector<PatchIndex> in_sight(PatchIndex j, std::span<const PatchIndex> others) const;

  const PatchMesh& mesh_;
  const FieldView& values_;
  const Occluder& occluder_;
  PatchesAtVertices at_vertex_;
};

// Such patches are taken to see each other.
bool Planes::are_about_equal(PatchIndex i, PatchIndex j) const {
  const auto larger = values_.row(i).max(values_.row(j));
  const auto smaller = values_.row(i).min(values_.row(j));
  return (larger <= 1.25 * smaller).all();
}

// Those that nothing hides from this one, a tenth of their distance above the polygon.
std::vector<PatchIndex> Planes::in_sight(PatchIndex j, std::span<const PatchIndex> others) const {
  std::vector<Segment> segments;
  for (const PatchIndex i : others) {
    const Vector up = 0.1 * (mesh_.centroid[i] - mesh_.centroid[j]).norm() * mesh_.normal[j];
    segments.push_back({mesh_.centroid[j] + up, mesh_.centroid[i] + up});
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  std::vector<PatchIndex> found;
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (arriving[k] > 0) found.push_back(others[k]);
  }
  return found;
}

std::vector<PatchIndex> Planes::patches_around(PatchIndex j) const {
  std::vector<PatchIndex> around;
  for (const std::uint32_t vertex : corner_vertices(mesh_, j)) {
    for (const PatchIndex i : at_vertex_[vertex]) {
      if (i != j && mesh_.polygon[i] == mesh_.polygon[j] && mesh_.side[i] == mesh_.side[j]) around.push_back(i);
    }
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  const auto unequal =
      std::stable_partition(around.begin(), around.end(), [&](PatchIndex i) { return are_about_equal(i, j); });
  if (unequal == around.end()) return around;
  const std::vector<PatchIndex> seen = in_sight(j, std::span<const PatchIndex>(unequal, around.end()));
  around.erase(unequal, around.end());
  around.insert(around.end(), seen.begin(), seen.end());
  return around;
}

// (sum d d^T) g = sum d (B_i - B_j), d the way from one centroid to the other; without slopes that would make the plane
// negative at a corner. Damping keeps the fit soluble where all neighbors lie in one direction.
Gradient Planes::fitted(PatchIndex j, std::span<const PatchIndex> around) const {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Gradient products = Gradient::Zero(3, values_.cols());
  for (const PatchIndex i : around) {
    const Vector d = mesh_.centroid[i] - mesh_.centroid[j];
    squares += d * d.transpose();
    products += d * (values_.row(i) - values_.row(j)).matrix();
  }
  const double size = squares.trace();
  if (!(size > 0)) return Gradient::Zero(3, values_.cols());
  // The damping of 1e-6 keeps the matrix regular where the patches lie on one line.
  squares += size * (mesh_.normal[j] * mesh_.normal[j].transpose() + 1e-6 * Eigen::Matrix3d::Identity());
  Gradient gradient = squares.ldlt().solve(products);
  const PatchCorners corners = mesh_.corner_points(j);
  for (Eigen::Index band = 0; band < values_.cols(); ++band) {
    double least = 0;
    for (const Point& corner : std::span<const Point>(corners))
      least = std::min(least, gradient.col(band).dot(corner - mesh_.centroid[j]));
    if (least < 0) gradient.col(band) *= std::clamp(values_(j, band) / -least, 0.0, 1.0);
  }
  return gradient;
}

// Root mean square, by the degrees of freedom that the two slopes of a plane leave; never more than the differences
// themselves.
Spectrum Planes::residual(PatchIndex j, std::span<const PatchIndex> around, const Gradient& gradient) const {
  Spectrum squares = Spectrum::Zero(values_.cols());
  Spectrum differences = Spectrum::Zero(values_.cols());
  for (const PatchIndex i : around) {
    const Vector d = mesh_.centroid[i] - mesh_.centroid[j];
    const Spectrum difference = values_.row(i) - values_.row(j);
    squares += (difference - (d.transpose() * gradient).array()).square();
    differences += difference.square();
  }
  const auto count = static_cast<double>(around.size());
  if (around.size() <= 2) return (differences / std::max(count, 1.0)).sqrt();
  return (squares / (count - 2)).min(differences / count).sqrt();
}

// So few patches may be alike by symmetry, whatever light is on the polygon side.
bool has_few_patches(const PatchMesh& mesh, PatchIndex j) {
  const auto [begin, end] = mesh.patches_on(mesh.polygon[j], mesh.side[j]);
  return end - begin <= 4;
}

// Fitted to the differences from the patches of the same polygon side that share a vertex, by least squares; 0 where
// there are none. Where one of two patches has a quarter more than the other and they do not see each other, something
// stands between them, and neither counts for the other. A plane that would fall below 0 at a corner of its patch is
// made less steep.
//
// The residual allows for curvature: half of the residual at the centroids of the patches around, or of the difference
// where these are too few. If the radiosity is curved evenly, a sixth of it is left at the edge of the patch, and more
// at narrower peaks (docs/theory/irradiance-at-a-point.md). Unknown is the part of `errors.display` that the plane does
// not explain. If that is not known and a polygon side has no more than four patches, it is all that these reflect.
// O(patches) with a bounded number around each vertex. Throws Canceled.
Slopes slopes_of(const PatchMesh& mesh, const FieldView& values, const Occluder& occluder,
                 const RadiosityErrors& errors, const Observer& observer) {
  const Planes planes(mesh, values, occluder);
  const Field& display = errors.display;
  const Field zero = Field::Zero(values.rows(), values.cols());
  Slopes found{Field::Zero(values.rows(), 3 * values.cols()), zero, zero};
  parallel_for(mesh.size(), Stage::gather, observer, [&](std::size_t row) {
    const auto j = static_cast<PatchIndex>(row);
    const std::vector<PatchIndex> around = planes.patches_around(j);
    const Gradient gradient = planes.fitted(j, around);
    found.residual.row(j) = 0.5 * planes.residual(j, around, gradient);
    for (Eigen::Index band = 0; band < values.cols(); ++band) {
      found.gradient.row(j).segment(3 * band, 3) = gradient.col(band).transpose().array();
      if (display.size() == 0) continue;
      const double unexplained = std::pow(display(j, band), 2) - variance_over(mesh, j, gradient.col(band));
      found.unknown(j, band) = std::sqrt(std::max(0.0, unexplained));
    }
    if (display.size() == 0 && errors.reflected.size() > 0 && has_few_patches(mesh, j))
      found.unknown.row(j) = errors.reflected.row(j);
  });
  return found;
}

// The radiosity to gather, and its errors.
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

// The part of each band that gets through colored panes.
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
    // Even curvature has no first moment about the plane, so that it counts in the second order.
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
  const Spectrum allowed = (options.wanted_error * reading.mean).square();
  const Spectrum unseen =
      (reading.variance > 0).select(Spectrum::Constant(allowed.size(), std::numeric_limits<double>::infinity()), 1.0);
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

// The errors by light that planes do not explain, and by the patches of the same mesh themselves.
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
  // A sensor that is nearer to a polygon's plane lies on it: the occluder's own limit.
  const double tolerance = tolerance_of_shapes / occluder.frame().scale;
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
