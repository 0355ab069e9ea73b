#include "gather/mirrored_gather.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/streams.h"
#include "gather/sources.h"
#include "lighting/receiver.h"
#include "mesh/patch_lookup.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <map>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

// The weight of each patch that a sensor sees in mirrors: the sensor's irradiance by a radiosity of 1.
using PatchWeights = std::map<PatchIndex, Spectrum>;

void add_weight(PatchWeights& weights, PatchIndex patch, const Spectrum& weight) {
  const auto [place, is_new] = weights.insert({patch, weight});
  if (!is_new) place->second += weight;
}

struct SeenInMirrors {
  const PatchMesh& mesh;
  const MirrorView& view;
  const Occluder& occluder;
  PatchLookup lookup;
  std::vector<std::vector<std::array<double, 4>>> points;  // per replicate

  void add(const SurfacePoint& at, std::uint32_t replicate, std::uint32_t key, PatchWeights& into) const;
};

// L = B h(theta) / (h pi) of the patch that each ray meets.
void SeenInMirrors::add(const SurfacePoint& at, std::uint32_t replicate, std::uint32_t key, PatchWeights& into) const {
  std::vector<MirrorRay> seen;
  view.add_rays(at, shifted(points[replicate], key), seen);
  std::vector<Ray> rays;
  for (const MirrorRay& one : seen) rays.push_back(one.ray);
  const auto hits = occluder.first_held_hits(rays, key);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    if (!hits[k]) continue;
    const auto patch = lookup.patch_at(hits[k]->polygon, hits[k]->side, hits[k]->point);
    if (!patch) continue;
    const Spectrum weight =
        seen[k].weight * occluder.relative_held(hits[k]->polygon, hits[k]->direction) / std::numbers::pi;
    add_weight(into, *patch, weight);
  }
}

Spectrum sum_of(const PatchWeights& weights, const FieldView& field, Eigen::Index bands) {
  Spectrum sum = Spectrum::Zero(bands);
  if (field.size() == 0) return sum;
  for (const auto& [patch, weight] : weights) sum += weight * field.row(patch);
  return sum;
}

// Independent errors of patches add up in squares, and each draw of correlated ones like light.
Spectrum sampling_variance(const PatchWeights& weights, const RadiosityErrors& errors, Eigen::Index bands) {
  Spectrum sum = Spectrum::Zero(bands);
  if (errors.sampling.size() == 0) return sum;
  for (const auto& [patch, weight] : weights) sum += (weight * errors.sampling.row(patch)).square();
  for (const Field& draw : errors.correlated)
    sum += sum_of(weights, draw, bands).square() / static_cast<double>(errors.correlated.size());
  return sum;
}

}  // namespace

GatheredIrradiance gather_mirrored(const PatchMesh& mesh, const FieldView& radiosity, const MirrorView& view,
                                   const Occluder& occluder, std::span<const Sensor> sensors,
                                   const MirroredGatherOptions& options, const Observer& observer) {
  SeenInMirrors gather{mesh, view, occluder, PatchLookup(mesh), {}};
  const std::uint32_t each = std::bit_ceil(std::max(2U, static_cast<std::uint32_t>(options.rays) / most_replicates));
  for (std::uint32_t r = 0; r < most_replicates; ++r)
    gather.points.push_back(scrambled_sobol(each, hash({options.seed, r, stream::points_of_mirrored_sensors})));

  const auto rows = static_cast<Eigen::Index>(sensors.size());
  const Eigen::Index bands = radiosity.cols();
  const Field none = Field::Zero(rows, bands);
  GatheredIrradiance found{none, {.rays = none, .sampling = none, .mesh = none, .solver = none}};
  parallel_for(sensors.size(), Stage::gather, observer, [&](std::size_t k) {
    const SurfacePoint at{sensors[k].point, sensors[k].normal, no_polygon};
    PatchWeights all;
    Field means(most_replicates, bands);
    for (std::uint32_t r = 0; r < most_replicates; ++r) {
      PatchWeights weights;
      gather.add(at, r, hash({options.seed, k, r, stream::shift_at_mirrored_sensor}), weights);
      means.row(r) = sum_of(weights, radiosity, bands);
      for (const auto& [patch, weight] : weights) add_weight(all, patch, weight / most_replicates);
    }
    const auto row = static_cast<Eigen::Index>(k);
    const auto [mean, variance] = estimate_of(means);
    found.irradiance.row(row) = mean;
    found.errors.rays.row(row) = variance.sqrt();
    found.errors.sampling.row(row) = sampling_variance(all, options.errors, bands).sqrt();
    found.errors.mesh.row(row) = sum_of(all, options.errors.mesh, bands);
    found.errors.solver.row(row) = sum_of(all, options.errors.solver, bands);
  });
  return found;
}

}  // namespace patchlight
