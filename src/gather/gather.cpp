#include "patchlight/gather/gather.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/form_factor/monte_carlo.h"
#include "patchlight/form_factor/point_polygon.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

// A patch that the sensor may see.
struct Source {
  PatchIndex patch = 0;
  double form_factor = 0;                     // unoccluded, from the sensor's point
  std::array<double, 2> free_weight = {};     // summed geometry terms of the shadow rays that are free, per half
  std::array<double, 2> blocked_weight = {};  // and of those that are blocked
};

// Shadow rays [begin, end) of a source; those from `half` on are its second half.
struct Samples {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::uint32_t half = 0;
};

double share(double free, double blocked) { return free + blocked > 0 ? free / (free + blocked) : 0; }

double visible(const Source& source) {
  return share(source.free_weight[0] + source.free_weight[1], source.blocked_weight[0] + source.blocked_weight[1]);
}

// Half the difference between the halves: the standard error of their mean. Where only the first rays were traced, they
// agree.
double visible_error(const Source& source) {
  if (source.free_weight[1] + source.blocked_weight[1] == 0) return 0;
  return 0.5 * std::abs(share(source.free_weight[0], source.blocked_weight[0]) -
                        share(source.free_weight[1], source.blocked_weight[1]));
}

// What patches add to the variance of which a part is hidden that the first rays do not notice, for each patch of which
// they do notice it, as a share of its squared unoccluded irradiance. Of straight edges laid at random over a square
// (uniform in direction and distance), four rays stratified in two rows and columns notice 0.55; the others cut off a
// share of 0.107 in the root of the mean square: 0.45 / 0.55 * 0.107^2, both integrated numerically. With more rays the
// edges that are not noticed cut off corners of an area as 1 / n, and edges that do so are as n^(-1/2).
double unnoticed_variance(int probes) { return 0.0093 * std::pow(4.0 / probes, 2.5); }

bool is_partly_hidden(const Source& source) { return visible(source) > 0 && visible(source) < 1; }

struct Gatherer {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const GatherOptions& options;
  std::vector<std::array<double, 4>> points;  // of the largest sample

  std::vector<Source> sources(const Sensor& sensor) const;
  void trace(const Sensor& sensor, std::span<Source> sources, const Samples& samples) const;
};

std::vector<Source> Gatherer::sources(const Sensor& sensor) const {
  std::vector<Source> found;
  for (PatchIndex j = 0; j < mesh.size(); ++j) {
    if (mesh.normal[j].dot(sensor.point - mesh.centroid[j]) <= 0) continue;
    const double form_factor = point_to_polygon(sensor.point, sensor.normal, mesh.corner_points(j));
    if (form_factor > 0) found.push_back({j, form_factor});
  }
  return found;
}

// Traces these samples of every source. Each source shifts the points by its own hash (Cranley and Patterson
// 1976).
void Gatherer::trace(const Sensor& sensor, std::span<Source> sources, const Samples& samples) const {
  std::vector<Segment> segments;
  std::vector<double> weights;
  const auto shifted = [](double u, std::uint32_t shift) {
    const double moved = u + shift * 0x1p-32;
    return moved < 1 ? moved : moved - 1;
  };
  for (const Source& source : sources) {
    const PatchCorners corners = mesh.corner_points(source.patch);
    for (std::uint32_t k = samples.begin; k < samples.end; ++k) {
      const double u = shifted(points[k][0], hash({options.seed, source.patch, 0}));
      const double v = shifted(points[k][1], hash({options.seed, source.patch, 1}));
      const Point y = square_to_quad(corners.points, u, v);
      segments.push_back({sensor.point, y, no_polygon, mesh.polygon[source.patch]});
      weights.push_back(geometry_term(sensor.point, sensor.normal, y, mesh.normal[source.patch]));
    }
  }
  const auto blocked = occluder.occluded(segments);
  const std::size_t count = samples.end - samples.begin;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    Source& source = sources[k / count];
    const std::size_t half = samples.begin + k % count < samples.half ? 0 : 1;
    (blocked[k] ? source.blocked_weight : source.free_weight)[half] += weights[k];
  }
}

}  // namespace

GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const FieldView& exitance,
                                     const Occluder& occluder, std::span<const Sensor> sensors,
                                     const GatherOptions& options, const Observer& observer) {
  const int most = std::max({options.probes, options.samples, options.emitter_samples});
  const Gatherer gatherer{mesh, occluder, options,
                          scrambled_sobol(static_cast<std::uint32_t>(most), hash({options.seed}))};
  const auto probes = static_cast<std::uint32_t>(options.probes);
  const auto all = static_cast<std::uint32_t>(options.samples);
  const auto to_lamps = static_cast<std::uint32_t>(options.emitter_samples);

  const Field zero = Field::Zero(static_cast<Eigen::Index>(sensors.size()), radiosity.cols());
  GatheredIrradiance result{zero, zero};
  parallel_for(sensors.size(), Stage::gather, observer, [&](std::size_t k) {
    std::vector<Source> sources = gatherer.sources(sensors[k]);

    // 1. Many shadow rays to the lamps, a few to all other patches, and more to those which are partly hidden.
    const auto lamps_end = std::stable_partition(sources.begin(), sources.end(),
                                                 [&](const Source& s) { return (exitance.row(s.patch) > 0).any(); });
    const std::span<Source> others(lamps_end, sources.end());
    gatherer.trace(sensors[k], {sources.begin(), lamps_end}, {0, to_lamps, to_lamps / 2});
    gatherer.trace(sensors[k], others, {0, probes, all / 2});
    const auto mixed_end = std::stable_partition(others.begin(), others.end(), is_partly_hidden);
    gatherer.trace(sensors[k], {others.begin(), mixed_end}, {probes, all, all / 2});

    // 2. E = sum_j F(x, j) V_j B_j, and its variance sum_j (F(x, j) B_j)^2 var V_j, with that of what was not noticed
    const auto row = static_cast<Eigen::Index>(k);
    for (const Source& source : sources) {
      result.irradiance.row(row) += source.form_factor * visible(source) * radiosity.row(source.patch);
      result.standard_error.row(row) +=
          (source.form_factor * visible_error(source) * radiosity.row(source.patch)).square();
    }
    for (const Source& source : std::span(others.begin(), mixed_end)) {
      result.standard_error.row(row) +=
          unnoticed_variance(options.probes) * (source.form_factor * radiosity.row(source.patch)).square();
    }
    result.standard_error.row(row) = result.standard_error.row(row).sqrt();
  });
  return result;
}

}  // namespace patchlight
