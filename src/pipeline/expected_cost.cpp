#include "pipeline/expected_cost.h"

#include "patchlight/transport/assemble.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "lighting/direct_irradiance.h"
#include "plan/choose_storage.h"
#include "plan/planned_scene.h"
#include "transport/pair_sampler.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Two clusters of so many, each pair as likely as any other; the lower number first.
ClusterPair random_pair(std::size_t clusters, std::uint32_t sample) {
  const std::size_t a = hash({sample, 0}) % clusters;
  const std::size_t b = hash({sample, 1}) % clusters;
  return {std::min(a, b), std::max(a, b)};
}

// The work of assembly for two clusters; their exchange areas summed up, so that none can be left out.
double find(const ClusterPairs& pairs, const ClusterPair& pair) {
  const PairClass pair_class = pairs.class_of(pair);
  if (pair_class == PairClass::averted || pair_class == PairClass::hidden) return 0;
  const PairSampler& sampler = pairs.sampler();
  double sum = 0;
  std::vector<Pair> sampled;
  pairs.for_facing(pair, all_lanes, all_lanes, [&](PatchIndex i, PatchIndex j, float unoccluded) {
    if (pair_class == PairClass::sampled) {
      sampled.push_back(sampler.new_pair(i, j, unoccluded));
    } else {
      sum += unoccluded < 0 ? sampler.exact(i, j) : unoccluded;
    }
  });
  for (const Pair& found : sampler.sampled(std::move(sampled))) sum += sampler.exchange_area(found);
  return sum;
}

// Processor seconds that assemble_exchange_areas() is expected to take with the automatic estimator: those of
// up to 1024 random pairs of clusters, scaled to the number of all pairs. Takes at most about 2 processor seconds.
double expected_assembly_seconds(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options) {
  const ClusterPairs pairs(mesh, occluder, options);
  const std::size_t clusters = pairs.clusters().size();
  const double all = static_cast<double>(clusters) * static_cast<double>(clusters + 1) / 2;
  const std::size_t samples = std::min<std::size_t>(1024, static_cast<std::size_t>(all));
  if (samples == 0) return 0;
  std::vector<double> sums(samples);
  const double start = cpu_seconds();
  double seconds = 0;
  std::size_t done = 0;
  while (done < samples && seconds < 2) {  // where rays are slow fewer samples do
    const std::size_t count = std::min<std::size_t>(64, samples - done);
    parallel_for(count, [&](std::size_t k) {
      sums[done + k] = find(pairs, random_pair(clusters, static_cast<std::uint32_t>(done + k)));
    });
    done += count;
    seconds = cpu_seconds() - start;
  }
  return seconds * all / static_cast<double>(done);
}

// The share of all rows that are those of lamps, by area.
double area_of_lamps(const Scene& scene, const Plan& plan, const PatchMesh& mesh) {
  double lamps = 0;
  double all = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    all += mesh.area[i];
    const bool of_front = plan.sides.emit_from_back && emits(scene, mesh.polygon[i], Side::front);
    if (of_front || emits(scene, mesh.polygon[i], mesh.side[i])) lamps += mesh.area[i];
  }
  return all > 0 ? lamps / all : 0;
}

// A matrix has half of all pairs, each row has as many as there are patches.
double assembly_seconds(const Scene& scene, const Plan& plan, const PatchMesh& mesh) {
  const Occluder occluder(scene, blockers_of(plan), *plan.coverings);
  const double of_matrix = expected_assembly_seconds(mesh, occluder, plan.assembly);
  const bool lamps_alone = !keeps_entries(plan.assembly.storage) && !simulates(plan, Effect::interreflection);
  return lamps_alone ? 2 * of_matrix * area_of_lamps(scene, plan, mesh) : of_matrix;
}

// Processor seconds of a patch, whose rays take 0.22 microseconds each.
double seconds_of_direct_light(const Scene& scene, const Plan& plan) {
  double rays = 0;
  if (simulates(plan, Effect::luminaires)) rays += 64.0 * static_cast<double>(scene.luminaires.size());
  if (scene.sun && simulates(plan, Effect::sun)) rays += 64;
  if (scene.sky && simulates(plan, Effect::sky)) rays += LightingOptions{}.sky_samples;
  return 2.2e-7 * rays;
}

// A sensor compares the radiosity of each patch with a limit and sends some thousands of rays. By daylight, which comes
// through few openings, it sends many more: measured in models of docs/benchmarks/real-models.md.
double seconds_of_a_sensor(const Scene& scene, const Plan& plan, double patches) {
  const bool by_day = (scene.sky && simulates(plan, Effect::sky)) || (scene.sun && simulates(plan, Effect::sun));
  return 1.5e-3 + 2.5e-8 * patches + (by_day ? 1.4e-2 : 0);
}

}  // namespace

ExpectedCost expected_cost(const Scene& scene, const Plan& plan, const PatchMesh& mesh) {
  const auto n = static_cast<double>(mesh.size());
  ExpectedCost cost{
      .patches = mesh.size(), .bytes = memory_needed(mesh.size(), plan), .of_first_mesh = refines(plan.accuracy)};
  for (const SensorGroup& group : scene.sensors) cost.sensors += group.sensors.size();
  cost.sensor_seconds = seconds_of_a_sensor(scene, plan, n) * static_cast<double>(cost.sensors);
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  cost.threads = plan.resources.threads > 0 ? plan.resources.threads : std::max(1, processors);
  cost.direct_light_seconds = seconds_of_direct_light(scene, plan) * n;

  // The rates are those of one core of an AMD EPYC, docs/benchmarks/speed.md.
  if (plan.assembly.storage == Storage::rays) {
    cost.form_factor_seconds = 1.2e-4 * n * plan.assembly.rays / AssemblyOptions().rays;
    cost.solve_seconds = 1.6e-5 * n;  // with last gather and smoothing
    return cost;
  }
  cost.form_factor_seconds = assembly_seconds(scene, plan, mesh) + 2.5e-7 * plan.assembly.lost_share_rays * n;
  // Closure takes about 50 to 250 products with the matrix, a solver about 15. A product has n^2 entries.
  const double products = (plan.assembly.close ? 100 : 0) + (simulates(plan, Effect::interreflection) ? 15 : 0);
  cost.solve_seconds = 1.1e-10 * products * n * n;
  return cost;
}

}  // namespace patchlight
