#include "transport/assembly_time.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "transport/cluster_pairs.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

constexpr std::size_t most_samples = 1024;
constexpr std::size_t samples_at_once = 64;

// Where rays are that slow, fewer samples tell as well.
constexpr double most_seconds = 2;

// Two clusters of so many, each pair as likely as any other; of the lower number first.
ClusterPair random_pair(std::size_t clusters, std::uint32_t sample) {
  const std::size_t a = hash({sample, 0}) % clusters;
  const std::size_t b = hash({sample, 1}) % clusters;
  return {std::min(a, b), std::max(a, b)};
}

// What assembly does for two clusters; their exchange areas summed up, so that none can be left out.
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

}  // namespace

double expected_assembly_seconds(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options) {
  const ClusterPairs pairs(mesh, occluder, options);
  const std::size_t clusters = pairs.clusters().size();
  const double all = static_cast<double>(clusters) * static_cast<double>(clusters + 1) / 2;
  const std::size_t samples = std::min(most_samples, static_cast<std::size_t>(all));
  if (samples == 0) return 0;
  std::vector<double> sums(samples);
  const double start = cpu_seconds();
  double seconds = 0;
  std::size_t done = 0;
  while (done < samples && seconds < most_seconds) {
    const std::size_t count = std::min(samples_at_once, samples - done);
    parallel_for(count, [&](std::size_t k) {
      sums[done + k] = find(pairs, random_pair(clusters, static_cast<std::uint32_t>(done + k)));
    });
    done += count;
    seconds = cpu_seconds() - start;
  }
  return seconds * all / static_cast<double>(done);
}

}  // namespace patchlight
