#include "gather/sources.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "base/tolerances.h"
#include "form_factor/point_polygon.h"
#include "visibility/walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

// Points of one replicate; where there are more rays, they repeat with another shift.
constexpr std::uint32_t most_points = 4096;

// A key of a place in a unit scene. Its coordinates are rounded to steps, so that rounding in another unit leaves the
// random numbers as they are. Round coordinates do not lie midway between two steps.
std::uint32_t key_of(const Vector& place) {
  std::array<std::uint64_t, 3> rounded{};
  for (int d = 0; d < 3; ++d)
    rounded[static_cast<std::size_t>(d)] = static_cast<std::uint64_t>(std::llround(1e6 * std::numbers::pi * place[d]));
  return hash({rounded[0], rounded[1], rounded[2]});
}

double shifted(double u, std::uint32_t shift) {
  const double moved = u + shift * 0x1p-32;
  return moved < 1 ? moved : moved - 1;
}

// Sums of cosine times solid angle over the rays of one replicate.
struct Weights {
  Eigen::Vector4d reached = Eigen::Vector4d::Zero();  // and times the way from the patch's centroid
  double visible = 0;                                 // of the rays that nothing opaque blocks
  double all = 0;
  Spectrum by_band = {};  // what is reached in each band, where these differ
};

// The ratios of the reached weights to all, with their covariance by the scatter of the replicates about them (Cochran
// 1977, section 6.4).
VisibleShare share_of(std::span<const Weights> replicates, double rays) {
  Eigen::Vector4d reached = Eigen::Vector4d::Zero();
  double visible = 0;
  double all = 0;
  Spectrum by_band = Spectrum::Zero(replicates[0].by_band.size());
  for (const Weights& one : replicates) {
    by_band += one.by_band;
    visible += one.visible;
    reached += one.reached;
    all += one.all;
  }
  VisibleShare share;
  share.rays = rays;
  if (!(all > 0)) return share;
  share.moments = reached / all;
  share.visible = visible / all;
  for (const Weights& one : replicates) {
    const Eigen::Vector4d off = (one.reached - share.moments * one.all) / all;
    share.covariance += off * off.transpose();
  }
  const auto count = static_cast<double>(replicates.size());
  share.covariance *= count / (count - 1);
  share.colour = reached[0] > 0 ? Spectrum(by_band / reached[0]) : Spectrum::Ones(by_band.size());
  return share;
}

}  // namespace

std::vector<Point> outline_above_horizon(const PatchMesh& mesh, PatchIndex patch, const Sensor& sensor) {
  const PatchCorners corners = mesh.corner_points(patch);
  const std::span<const Point> points = corners;
  const bool is_cut = std::any_of(points.begin(), points.end(),
                                  [&](const Point& corner) { return sensor.normal.dot(corner - sensor.point) < 0; });
  return is_cut ? clip_to_half_space(points, sensor.point, sensor.normal)
                : std::vector<Point>(points.begin(), points.end());
}

Sources sources_before(const Sensor& sensor, const PatchMesh& mesh, const FieldView& radiosity, const Spectrum& limit,
                       const Occluder& occluder) {
  // A sensor that is nearer to a polygon's plane lies on it: the occluder's own limit.
  const double tolerance = tolerance_of_shapes / occluder.frame().scale;
  Sources found;
  found.unoccluded = Spectrum::Zero(radiosity.cols());
  for (PatchIndex j = 0; j < mesh.size(); ++j) {
    if (!(radiosity.row(j) > limit).any()) {
      found.is_rest_lit = found.is_rest_lit || (radiosity.row(j) > 0).any();
      continue;
    }
    if (mesh.normal[j].dot(sensor.point - mesh.centroid[j]) <= tolerance) continue;
    std::vector<Point> outline = outline_above_horizon(mesh, j, sensor);
    if (outline.empty()) continue;
    const double form_factor = point_to_polygon(sensor.point, sensor.normal, outline);
    if (!(form_factor > 0)) continue;
    if (occluder.hides(std::span(&sensor.point, 1), outline, std::span(&mesh.polygon[j], 1))) continue;
    found.unoccluded += form_factor * radiosity.row(j);
    found.bright.push_back({j, std::move(outline), form_factor});
  }
  const double bands = std::max<double>(1, static_cast<double>((found.unoccluded > 0).count()));
  const Spectrum weight = (found.unoccluded > 0).select(1 / (bands * found.unoccluded), 0.0);
  for (Source& source : found.bright)
    source.light_share = source.form_factor * (radiosity.row(source.patch) * weight).sum();
  return found;
}

RayCounts ray_counts(double rays) {
  const auto wanted = static_cast<std::uint32_t>(std::ceil(std::max(rays, 2.0)));
  const std::uint32_t replicates = std::clamp(wanted / 2, 2U, most_replicates);
  return {replicates, (wanted + replicates - 1) / replicates};
}

std::uint64_t key_of(const Sensor& sensor, const TracingFrame& frame, std::uint64_t seed, std::uint32_t stage) {
  return hash({seed, key_of(frame.scale * (sensor.point - frame.centre)), key_of(sensor.normal), stage});
}

HemisphereRays::HemisphereRays(const PatchMesh& mesh, const Occluder& occluder, const SurfaceOptics& optics,
                               Eigen::Index bands, std::uint64_t seed, const SpecularAim* aim)
    : mesh_(mesh),
      occluder_(occluder),
      optics_(optics),
      bands_(bands),
      aim_(aim),
      seed_(seed),
      lookup_(mesh),
      points_(scrambled_sobol(most_points, hash({seed, stream::hemisphere_of_sensor}))) {}

Spectrum HemisphereRays::by_band(const Spectrum& throughput) const {
  return throughput.size() == bands_ ? throughput : Spectrum::Constant(bands_, throughput.mean());
}

// Each replicate shifts the points by its own hash (Cranley and Patterson 1976).
std::vector<std::array<double, 2>> HemisphereRays::samples(std::uint64_t key, std::uint32_t replicate,
                                                           std::uint32_t count) const {
  std::vector<std::array<double, 2>> samples;
  samples.reserve(count);
  std::array<std::uint32_t, 2> shift{};
  for (std::uint32_t k = 0; k < count; ++k) {
    if (k % most_points == 0)
      for (std::uint32_t d = 0; d < 2; ++d) shift[d] = hash({key, 2 * replicate + d, k / most_points});
    const auto& point = points_[k % most_points];
    samples.push_back({shifted(point[0], shift[0]), shifted(point[1], shift[1])});
  }
  return samples;
}

HemisphereHits HemisphereRays::hits(const Sensor& sensor, std::uint32_t each, std::uint32_t stage) const {
  const std::uint64_t key = hash({key_of(sensor, occluder_.frame(), seed_, stage), stream::hemisphere_of_sensor});
  const SurfacePoint at{sensor.point, sensor.normal};
  const Chooser targets = aim_ != nullptr ? aim_->targets_from(at) : Chooser();
  const std::uint32_t count = targets.empty() ? each : 2 * each;
  HemisphereHits found{{}, static_cast<double>(most_replicates) * count};
  for (std::uint32_t r = 0; r < most_replicates; ++r) {
    std::vector<Ray> rays;
    std::vector<double> form_factors;
    const auto add = [&](const Ray& ray, double weight) {
      rays.push_back(ray);
      form_factors.push_back(weight / (std::numbers::pi * most_replicates));  // L = B / pi
    };
    const std::vector<std::array<double, 2>> samples = this->samples(key, r, count);
    if (!targets.empty())
      for (const auto& [ray, weight] : aim_->rays(at, targets, samples)) add(ray, weight);
    else
      for (const auto& [u, v] : samples)
        add({sensor.point, cosine_direction(sensor.normal, u, v)}, std::numbers::pi / count);
    walk(occluder_, optics_, std::move(rays), {.seed = hash({key, r})},
         [&](const SpecularPath& path, const std::optional<Hit>& hit) {
           if (!hit) return Continuation::ends;
           const double form_factor = form_factors[path.start];
           const double profile = occluder_.optics().nonspecular_profile(hit->polygon, hit->direction);
           if (const auto patch = lookup_.patch_at(hit->polygon, hit->side, hit->point))
             found.all.push_back({*patch, r, hit->point, path.distance + hit->distance, form_factor,
                                  form_factor * profile * by_band(path.throughput), path.reflections > 0});
           return Continuation::specular;
         });
  }
  return found;
}

ShadowRays::ShadowRays(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t seed, const LightPaths* coloured)
    : mesh_(mesh),
      occluder_(occluder),
      coloured_(coloured),
      seed_(seed),
      points_(scrambled_sobol(most_points, hash({seed}))) {}

// Points are uniform in the solid angle of the source: of a large source close by, points uniform in its area would
// miss the part that counts. Each replicate shifts the points by its own hash (Cranley and Patterson 1976).
ShadowRays::Rays ShadowRays::rays(const Sensor& sensor, std::span<const ChosenSource> sources,
                                  std::uint32_t stage) const {
  const std::uint64_t key = key_of(sensor, occluder_.frame(), seed_, stage);
  Rays all;
  for (const ChosenSource& chosen : sources) {
    const Source& source = *chosen.source;
    const PatchIndex j = source.patch;
    for (std::uint32_t r = 0; r < chosen.rays.replicates; ++r) {
      std::array<std::uint32_t, 2> shift{};
      for (std::uint32_t k = 0; k < chosen.rays.each; ++k) {
        if (k % most_points == 0)
          for (std::uint32_t d = 0; d < 2; ++d) shift[d] = hash({key, j, 2 * r + d, k / most_points});
        const auto& point = points_[k % most_points];
        const SeenPoint seen =
            sample_seen_point(sensor.point, source.outline, shifted(point[0], shift[0]), shifted(point[1], shift[1]));
        const Point to = seen.solid_angle > 0 ? seen.point : source.outline[0];
        const double cosine = sensor.normal.dot((to - sensor.point).normalized());
        all.segments.push_back({sensor.point, to, no_polygon, mesh_.polygon[j]});
        all.weights.push_back(std::max(0.0, cosine) * seen.solid_angle * seen.weight);
      }
    }
  }
  return all;
}

std::vector<VisibleShare> ShadowRays::visible_shares(const Sensor& sensor, std::span<const ChosenSource> sources,
                                                     std::uint32_t stage) const {
  const auto [segments, weights] = rays(sensor, sources, stage);
  const std::vector<float> arriving = occluder_.transmittance(segments);
  const Field by_band = coloured_ != nullptr ? coloured_->transmittance(segments) : Field();
  std::vector<VisibleShare> shares;
  std::size_t ray = 0;
  for (const ChosenSource& chosen : sources) {
    const RayCounts& count = chosen.rays;
    std::array<Weights, most_replicates> replicates{};
    for (Weights& replicate : replicates) replicate.by_band = Spectrum::Zero(by_band.cols());
    for (std::uint32_t r = 0; r < count.replicates; ++r) {
      for (std::uint32_t k = 0; k < count.each; ++k, ++ray) {
        replicates[r].all += weights[ray];
        if (arriving[ray] > 0) replicates[r].visible += weights[ray];
        const double reached = static_cast<double>(arriving[ray]) * weights[ray];
        const Vector way = segments[ray].to - mesh_.centroid[chosen.source->patch];
        replicates[r].reached += reached * Eigen::Vector4d(1, way.x(), way.y(), way.z());
        if (by_band.size() == 0 || !(reached > 0)) continue;
        const Segment& segment = segments[ray];
        const double sent =
            occluder_.optics().nonspecular_profile(segment.to_polygon, (segment.to - segment.from).normalized());
        replicates[r].by_band += weights[ray] * sent * by_band.row(static_cast<Eigen::Index>(ray));
      }
    }
    shares.push_back(share_of(std::span(replicates).first(count.replicates), count.replicates * count.each));
  }
  return shares;
}

}  // namespace patchlight
