#include "patchlight/gather/gather.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/form_factor/monte_carlo.h"
#include "patchlight/form_factor/point_polygon.h"

#include <algorithm>
#include <array>
#include <vector>

namespace patchlight {
namespace {

// A patch that the sensor may see.
struct Source {
  PatchIndex patch = 0;
  double form_factor = 0;     // unoccluded, from the sensor's point
  double free_weight = 0;     // summed geometry terms of the shadow rays that are free
  double blocked_weight = 0;  // and of those that are blocked
};

struct Gatherer {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const GatherOptions& options;
  std::vector<std::array<double, 4>> points;  // of the largest sample

  std::vector<Source> sources(const Sensor& sensor) const;
  void trace(const Sensor& sensor, std::span<Source> sources, std::uint32_t begin, std::uint32_t end) const;
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

// Traces samples [begin, end) of every source. Each source shifts the points by its own hash (Cranley and Patterson
// 1976).
void Gatherer::trace(const Sensor& sensor, std::span<Source> sources, std::uint32_t begin, std::uint32_t end) const {
  std::vector<Segment> segments;
  std::vector<double> weights;
  const auto shifted = [](double u, std::uint32_t shift) {
    const double moved = u + shift * 0x1p-32;
    return moved < 1 ? moved : moved - 1;
  };
  for (const Source& source : sources) {
    const PatchCorners corners = mesh.corner_points(source.patch);
    for (std::uint32_t k = begin; k < end; ++k) {
      const double u = shifted(points[k][0], hash({options.seed, source.patch, 0}));
      const double v = shifted(points[k][1], hash({options.seed, source.patch, 1}));
      const Point y = square_to_quad(corners.points, u, v);
      segments.push_back({sensor.point, y, no_polygon, mesh.polygon[source.patch]});
      weights.push_back(geometry_term(sensor.point, sensor.normal, y, mesh.normal[source.patch]));
    }
  }
  const auto blocked = occluder.occluded(segments);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    Source& source = sources[k / (end - begin)];
    (blocked[k] ? source.blocked_weight : source.free_weight) += weights[k];
  }
}

}  // namespace

Field gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const FieldView& exitance,
                        const Occluder& occluder, std::span<const Sensor> sensors, const GatherOptions& options,
                        const Observer& observer) {
  const int most = std::max({options.probes, options.samples, options.emitter_samples});
  const Gatherer gatherer{mesh, occluder, options,
                          scrambled_sobol(static_cast<std::uint32_t>(most), hash({options.seed}))};
  const auto probes = static_cast<std::uint32_t>(options.probes);

  Field irradiance = Field::Zero(static_cast<Eigen::Index>(sensors.size()), radiosity.cols());
  parallel_for(sensors.size(), Stage::gather, observer, [&](std::size_t k) {
    std::vector<Source> sources = gatherer.sources(sensors[k]);

    // 1. Many shadow rays to the lamps, a few to all other patches, and more to those which are partly hidden.
    const auto lamps_end = std::stable_partition(sources.begin(), sources.end(),
                                                 [&](const Source& s) { return (exitance.row(s.patch) > 0).any(); });
    const std::span<Source> lamps(sources.begin(), lamps_end);
    const std::span<Source> others(lamps_end, sources.end());
    gatherer.trace(sensors[k], lamps, 0, static_cast<std::uint32_t>(options.emitter_samples));
    gatherer.trace(sensors[k], others, 0, probes);
    const auto mixed_end = std::stable_partition(
        others.begin(), others.end(), [](const Source& s) { return s.free_weight > 0 && s.blocked_weight > 0; });
    gatherer.trace(sensors[k], {others.begin(), mixed_end}, probes, static_cast<std::uint32_t>(options.samples));

    // 2. E = sum_j F(x, j) V_j B_j
    for (const Source& source : sources) {
      const double total = source.free_weight + source.blocked_weight;
      const double visible = total > 0 ? source.free_weight / total : 0;
      irradiance.row(static_cast<Eigen::Index>(k)) += source.form_factor * visible * radiosity.row(source.patch);
    }
  });
  return irradiance;
}

}  // namespace patchlight
