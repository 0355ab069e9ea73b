#include "patchlight/gather/gather.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "form_factor/point_polygon.h"
#include "gather/planes.h"
#include "gather/sources.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "visibility/occluder.h"

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
      : mesh_(mesh), values_(values), fits_(mesh, occluder) {}

  std::vector<PatchIndex> patches_around(PatchIndex j) const;
  Gradient fitted(PatchIndex j, std::span<const PatchIndex> around) const;
  Spectrum residual(PatchIndex j, std::span<const PatchIndex> around, const Gradient& gradient) const;

 private:
  bool are_about_equal(PatchIndex i, PatchIndex j) const;

  const PatchMesh& mesh_;
  const FieldView& values_;
  PlaneFits fits_;
};

// Such patches are taken to see each other.
bool Planes::are_about_equal(PatchIndex i, PatchIndex j) const {
  const auto larger = values_.row(i).max(values_.row(j));
  const auto smaller = values_.row(i).min(values_.row(j));
  return (larger <= 1.25 * smaller).all();
}

std::vector<PatchIndex> Planes::patches_around(PatchIndex j) const {
  std::vector<PatchIndex> around = fits_.patches_around(j);
  const auto unequal =
      std::stable_partition(around.begin(), around.end(), [&](PatchIndex i) { return are_about_equal(i, j); });
  if (unequal == around.end()) return around;
  const std::vector<PatchIndex> seen = fits_.in_sight(j, std::span<const PatchIndex>(unequal, around.end()));
  around.erase(unequal, around.end());
  around.insert(around.end(), seen.begin(), seen.end());
  return around;
}

// Without slopes that would make the plane negative at a corner.
Gradient Planes::fitted(PatchIndex j, std::span<const PatchIndex> around) const {
  Gradient gradient = Gradient::Zero(3, values_.cols());
  const Eigen::Matrix3Xd slopes = fits_.slopes(j, around);
  for (std::size_t k = 0; k < around.size(); ++k)
    gradient += slopes.col(static_cast<Eigen::Index>(k)) * (values_.row(around[k]) - values_.row(j)).matrix();
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
  const FieldView* mirrored;  // the part that mirrors show; null if nothing is mirrored
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
  double rays = 0;
};

constexpr std::array parts_of_reading = {&Reading::mean,   &Reading::variance, &Reading::sampling,
                                         &Reading::mesh,   &Reading::solver,   &Reading::unexplained,
                                         &Reading::hidden, &Reading::reflected};

// A patch as a sensor sees it, per band.
struct SeenPatch {
  PatchIndex patch = 0;
  Spectrum weight;                // irradiance by a radiosity of 1
  Spectrum square;                // of the weight
  Spectrum hidden;                // the weight times the share of the patch that is not visible
  double squared_unevenness = 0;  // squared_unevenness()
};

// The data that all sensors of a run share.
struct Gather {
  const Light& light;
  const ShadowRays& shadow_rays;
  const HemisphereRays& hemisphere;
  const GatherOptions& options;
  const Occluder& occluder;

  // A sensor that is nearer to a polygon's plane lies on it: the occluder's own limit.
  double tolerance() const { return tolerance_of_shapes / occluder.frame().scale; }
};

// How unevenly a sensor sees a patch, squared: e^2 / (e^2 + d^2), e its longest edge and d its distance. From afar all
// points of the patch count alike. Close by the nearest points alone count.
double squared_unevenness(const PatchMesh& mesh, PatchIndex j, double squared_distance) {
  const double longest = longest_edge_squared(mesh.corner_points(j));
  return longest / (longest + squared_distance);
}

// The errors of patches, as a sensor sees them.
class ErrorsOfPatches {
 public:
  ErrorsOfPatches(const Light& light, Reading& reading)
      : light_(light),
        reading_(reading),
        draws_(Field::Zero(static_cast<Eigen::Index>(light.errors.correlated.size()), reading.mean.size())) {}

  void add(const SeenPatch& seen);
  void finish() {
    if (draws_.rows() > 0) reading_.sampling += draws_.square().colwise().mean();
  }

 private:
  const Light& light_;
  Reading& reading_;
  Field draws_;  // per draw of the correlated errors
};

void ErrorsOfPatches::add(const SeenPatch& seen) {
  const auto& [sampling, correlated, mesh, solver, display, reflected] = light_.errors;
  const PatchIndex j = seen.patch;
  if (sampling.size() > 0) reading_.sampling += seen.square * sampling.row(j).square();
  for (Eigen::Index k = 0; k < draws_.rows(); ++k)
    draws_.row(k) += seen.weight * correlated[static_cast<std::size_t>(k)].row(j);
  if (mesh.size() > 0) reading_.mesh += seen.weight * mesh.row(j);
  if (solver.size() > 0) reading_.solver += seen.weight * solver.row(j);
  if (reflected.size() > 0) reading_.reflected += seen.weight * reflected.row(j);
  const Slopes& slopes = light_.slopes;
  if (slopes.residual.size() == 0) return;
  // Even curvature has no first moment about the plane, so that it counts in the second order.
  const double squared = seen.squared_unevenness;
  const Spectrum by_points = (squared * slopes.residual.row(j)).max(std::sqrt(squared) * slopes.unknown.row(j));
  reading_.unexplained += seen.square * by_points.square();
  // Let radiosity vary linearly with standard deviation sigma. Its mean over an end of share v differs from the patch's
  // by sqrt(3) (1 - v) sigma. Sensors behind a grid see the same end of all its faces, so these errors add up.
  reading_.hidden += seen.hidden * slopes.residual.row(j).max(std::numbers::sqrt3 * slopes.unknown.row(j));
}

// The plane of a patch's radiosity in one band, directly or in mirrors: its mean and its gradient.
Eigen::Vector4d plane_of(const Light& light, PatchIndex j, Eigen::Index band, bool is_mirrored = false) {
  Eigen::Vector4d plane(is_mirrored ? (*light.mirrored)(j, band) : light.radiosity(j, band), 0, 0, 0);
  if (light.slopes.gradient.size() > 0)
    plane.tail<3>() = light.slopes.gradient.row(j).segment(3 * band, 3).matrix().transpose();
  return plane;
}

// Patches get shadow rays of their own if their radiosity is above so many times the irradiance of the sensor. Rays of
// the hemisphere find the light of all others: n of them leave a relative variance of this number / n at most, and less
// as they are stratified.
constexpr double bright_factor = 2;

// Bright patches share the rays in proportion to their possible light. Half of them go by light, half by form factor: a
// lamp that is hidden does not take all rays. A patch that would get fewer than the least number gets that, or none,
// with a probability that keeps the mean.
std::vector<ChosenSource> chosen_sources(const Sources& found, const Spectrum& limit, const Gather& gather,
                                         double times, std::uint64_t key) {
  const std::span<const Source> sources = found.bright;
  const Spectrum possible = found.unoccluded + limit / bright_factor;
  const double share = (possible > 0).select(found.unoccluded / possible, 0.0).maxCoeff();
  const double rays = times * share * gather.options.rays;
  const double least = gather.options.least_rays;
  const auto count = static_cast<double>(sources.size());
  const bool all = least * count <= rays;
  const double each = all ? std::min(times * least, rays / std::max(1.0, count)) : least;
  double form_factors = 0;
  for (const Source& source : sources) form_factors += source.form_factor;
  std::vector<ChosenSource> chosen;
  for (const Source& source : sources) {
    const double wanted = rays * (source.light_share + source.form_factor / form_factors) / 2;
    const double probability = all ? 1 : std::min(1.0, wanted / least);
    const double u = hash({key, stream::choice_of_bright_patch, source.patch}) * 0x1p-32;
    if (u >= probability) continue;
    chosen.push_back({&source, ray_counts(all ? each + wanted : std::max(each, wanted)), probability});
  }
  return chosen;
}

// E = sum_j F(x, j) (B_j V_j + g_j . m_j) / p_j, V_j the visible share, m_j its first moment and p_j the probability of
// rays to j; and its variance (Horvitz and Thompson 1952). If all rays to a patch agree, they may still miss a gap or
// an obstacle: the heaviest of all such rays counts as an error. A patch that was chosen at random counts as a whole,
// because those that were not chosen may be visible.
std::vector<SeenPatch> add_bright_patches(const Gather& gather, const Sensor& sensor, const Sources& sources,
                                          const Spectrum& limit, double times, std::uint32_t stage, Reading& reading,
                                          ErrorsOfPatches& errors) {
  const std::vector<ChosenSource> chosen = chosen_sources(
      sources, limit, gather, times, key_of(sensor, gather.occluder.frame(), gather.options.seed, stage));
  const std::vector<VisibleShare> shares = gather.shadow_rays.visible_shares(sensor, chosen, stage);
  const Eigen::Index bands = reading.mean.size();
  Spectrum heaviest = Spectrum::Zero(bands);
  std::vector<SeenPatch> seen;
  for (std::size_t s = 0; s < chosen.size(); ++s) {
    const auto& [source, rays, probability] = chosen[s];
    const VisibleShare& share = shares[s];
    const Spectrum factor =
        source->form_factor / probability * (share.colour.size() > 0 ? share.colour : Spectrum(Spectrum::Ones(bands)));
    for (Eigen::Index band = 0; band < bands; ++band) {
      const Eigen::Vector4d plane = factor[band] * plane_of(gather.light, source->patch, band);
      const double sent = plane.dot(share.moments);
      reading.mean[band] += sent;
      reading.variance[band] += probability * plane.dot(share.covariance * plane) + (1 - probability) * sent * sent;
    }
    reading.rays += share.rays;
    if (!(share.covariance(0, 0) > 0))
      heaviest = heaviest.max(factor * gather.light.radiosity.row(source->patch) / (probability < 1 ? 1 : share.rays));
    if (!(share.mean() > 0)) continue;
    const PatchMesh& mesh = gather.light.mesh;
    const Spectrum weight = factor * share.mean();
    const double squared_distance = (mesh.centroid[source->patch] - sensor.point).squaredNorm();
    // E[v (1 - v)] of a sampled share v is too small by its variance.
    const double hidden = share.mean() * (1 - share.visible) + share.covariance(0, 0) * share.visible / share.mean();
    seen.push_back({source->patch, weight, probability * weight.square(), factor * hidden,
                    squared_unevenness(mesh, source->patch, squared_distance)});
    errors.add(seen.back());
  }
  reading.variance += heaviest.square();
  return seen;
}

// An unbiased estimate of the product of two means from their sums over independent replicates (rows).
Spectrum product_of_means(const Field& a, const Field& b) {
  const Spectrum all = a.colwise().sum() * b.colwise().sum();
  return (all - (a * b).colwise().sum()) * most_replicates / (most_replicates - 1.0);
}

// The errors of a patch that paths meet. The visible share is that of straight rays without their losses in panes. A
// bright patch is met in mirrors only. With its weight w by shadow rays, (w + w')^2 - w^2 = w'^2 + 2 w w' is added.
void add_errors(const Gather& gather, const Sensor& sensor, std::span<const HemisphereHit> hits,
                std::span<const SeenPatch> bright, ErrorsOfPatches& errors) {
  const PatchMesh& mesh = gather.light.mesh;
  const PatchIndex j = hits.front().patch;
  const Field none = Field::Zero(most_replicates, hits.front().weight.size());
  Field weights = none, straight = none, form_factors = none;
  double unevenness = 0, sum = 0;
  for (const HemisphereHit& hit : hits) {
    weights.row(hit.replicate) += hit.weight;
    const double squared_distance =
        hit.is_mirrored ? hit.distance * hit.distance : (mesh.centroid[j] - sensor.point).squaredNorm();
    unevenness += hit.form_factor * squared_unevenness(mesh, j, squared_distance);
    sum += hit.form_factor;
    if (hit.is_mirrored) continue;
    straight.row(hit.replicate) += hit.weight;
    form_factors.row(hit.replicate) += hit.form_factor;
  }
  Spectrum hidden = straight.colwise().sum();
  const double unoccluded = point_to_polygon(sensor.point, sensor.normal, outline_above_horizon(mesh, j, sensor));
  if (unoccluded > 0) hidden -= product_of_means(straight, form_factors) / unoccluded;
  const Spectrum weight = weights.colwise().sum();
  Spectrum square = product_of_means(weights, weights);
  const auto direct = std::lower_bound(bright.begin(), bright.end(), j,
                                       [](const SeenPatch& seen, PatchIndex patch) { return seen.patch < patch; });
  if (direct != bright.end() && direct->patch == j) square += 2 * direct->weight * weight;
  errors.add({j, weight, square, hidden, unevenness / sum});
}

// E = sum over rays of w (B_j + g_j . (y - c_j)) at the points y that paths meet. Bright patches count in mirrors
// alone.
void add_other_patches(const Gather& gather, const Sensor& sensor, const Spectrum& limit, double times,
                       std::uint32_t stage, std::span<const SeenPatch> bright, Reading& reading,
                       ErrorsOfPatches& errors) {
  const PatchMesh& mesh = gather.light.mesh;
  const FieldView& radiosity = gather.light.radiosity;
  const auto each = static_cast<std::uint32_t>(std::ceil(std::max(2.0, times * gather.options.rays / most_replicates)));
  auto [hits, rays] = gather.hemisphere.hits(sensor, each, stage);
  std::erase_if(hits, [&](const HemisphereHit& hit) {
    const double height = mesh.normal[hit.patch].dot(sensor.point - mesh.centroid[hit.patch]);
    return !hit.is_mirrored && ((radiosity.row(hit.patch) > limit).any() || height <= gather.tolerance());
  });
  const Eigen::Index bands = reading.mean.size();
  Field means = Field::Zero(most_replicates, bands);
  for (const HemisphereHit& hit : hits) {
    Eigen::Vector4d place(1, 0, 0, 0);
    place.tail<3>() = hit.point - mesh.centroid[hit.patch];
    for (Eigen::Index band = 0; band < bands; ++band) {
      const Eigen::Vector4d plane = plane_of(gather.light, hit.patch, band, hit.is_mirrored);
      means(hit.replicate, band) += most_replicates * hit.weight[band] * plane.dot(place);
    }
  }
  const Spectrum mean = means.colwise().mean();
  reading.mean += mean;
  reading.variance += (means.rowwise() - mean).square().colwise().sum() / (most_replicates * (most_replicates - 1.0));
  reading.rays += rays;
  std::stable_sort(hits.begin(), hits.end(),
                   [](const HemisphereHit& a, const HemisphereHit& b) { return a.patch < b.patch; });
  for (auto first = hits.begin(); first != hits.end();) {
    const auto last = std::find_if(first, hits.end(), [&](const auto& hit) { return hit.patch != first->patch; });
    add_errors(gather, sensor, {first, last}, bright, errors);
    first = last;
  }
}

// One estimate, with `times` as many rays as the options have.
Reading estimate(const Gather& gather, const Sensor& sensor, const Sources& sources, const Spectrum& limit,
                 double times, std::uint32_t stage) {
  Reading reading;
  for (Spectrum Reading::*const part : parts_of_reading) reading.*part = Spectrum::Zero(limit.size());
  ErrorsOfPatches errors(gather.light, reading);
  const std::vector<SeenPatch> bright =
      add_bright_patches(gather, sensor, sources, limit, times, stage, reading, errors);
  if (sources.is_rest_lit || gather.light.mirrored != nullptr)
    add_other_patches(gather, sensor, limit, times, stage, bright, reading, errors);
  errors.finish();
  reading.hidden = reading.hidden.max(0);
  return reading;
}

// The mean of two independent estimates by the number of their rays.
Reading together(const Reading& first, const Reading& second) {
  const double rays = first.rays + second.rays;
  const double a = first.rays / rays, b = second.rays / rays;
  Reading both;
  for (Spectrum Reading::*const part : parts_of_reading) both.*part = a * (first.*part) + b * (second.*part);
  both.variance = a * a * first.variance + b * b * second.variance;
  both.rays = rays;
  return both;
}

// Rays have at most this share in the square of a sensor's error if others are larger than the wanted error.
constexpr double smallest_share_of_rays = 0.02;

// How many times as many rays would leave the wanted error: no number where nothing is seen yet of what may be seen.
double wanted_factor(const Reading& reading, std::size_t sensor, const GatherOptions& options) {
  Spectrum light = reading.mean;
  Spectrum others = reading.sampling + reading.mesh.square() + reading.unexplained + reading.hidden.square();
  if (options.other != nullptr) {
    light += options.other->mean.row(static_cast<Eigen::Index>(sensor));
    others += options.other->standard_error.row(static_cast<Eigen::Index>(sensor)).square();
  }
  const Spectrum allowed = (options.wanted_error * light).square().max(smallest_share_of_rays * others);
  const Spectrum unseen =
      (reading.variance > 0).select(Spectrum::Constant(allowed.size(), std::numeric_limits<double>::infinity()), 1.0);
  const Spectrum factor = (allowed > 0).select(reading.variance / allowed, unseen);
  return std::max(1.0, factor.maxCoeff());
}

// The radiosity above which patches count as bright at a sensor. A few pilot rays estimate it; the reading does not use
// them. It is 0 where the mesh is so small that each patch may get its own rays.
Spectrum limit_of_bright(const Gather& gather, const Sensor& sensor) {
  constexpr std::uint32_t each = 32;
  Spectrum sum = Spectrum::Zero(gather.light.radiosity.cols());
  const auto least = static_cast<double>(gather.options.least_rays) * gather.light.mesh.size();
  if (least <= gather.options.rays) return sum;
  for (const HemisphereHit& hit : gather.hemisphere.hits(sensor, each, 2).all)
    if (!hit.is_mirrored) sum += hit.weight * gather.light.radiosity.row(hit.patch);
  return bright_factor * sum;
}

Reading read_sensor(const Gather& gather, const Sensor& sensor, std::size_t number) {
  const Spectrum limit = limit_of_bright(gather, sensor);
  const Sources sources = sources_before(sensor, gather.light.mesh, gather.light.radiosity, limit, gather.occluder);
  Reading first = estimate(gather, sensor, sources, limit, 1, 0);
  const double more =
      std::min((wanted_factor(first, number, gather.options) - 1) * first.rays, gather.options.most_rays - first.rays);
  if (!(more > first.rays / 2)) return first;
  return together(first, estimate(gather, sensor, sources, limit, more / first.rays, 1));
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
  const SurfaceOptics& optics = options.paths != nullptr ? *options.paths->optics() : occluder.optics();
  const ShadowRays shadow_rays(mesh, occluder, options.seed, optics.transmits_colour() ? options.paths : nullptr);
  const HemisphereRays hemisphere(mesh, occluder, optics, radiosity.cols(), options.seed, options.aim);
  const FieldView mirrored = options.mirrored_light != nullptr ? FieldView(*options.mirrored_light) : radiosity;
  const Light light{mesh, radiosity,
                    options.slopes ? slopes_of(mesh, radiosity, occluder, options.errors, observer) : Slopes{},
                    options.errors, optics.follows_reflections() ? &mirrored : nullptr};
  const Gather gather{light, shadow_rays, hemisphere, options, occluder};
  std::vector<Reading> readings(sensors.size());
  parallel_for(sensors.size(), Stage::gather, observer,
               [&](std::size_t k) { readings[k] = read_sensor(gather, sensors[k], k); });
  const Eigen::Index bands = radiosity.cols();
  const Field irradiance = column_of(readings, &Reading::mean, bands);
  return {irradiance,
          {.rays = column_of(readings, &Reading::variance, bands).sqrt(),
           .sampling = column_of(readings, &Reading::sampling, bands).sqrt(),
           .mesh = mesh_part(readings, irradiance, options.errors),
           .solver = column_of(readings, &Reading::solver, bands)}};
}

}  // namespace patchlight
