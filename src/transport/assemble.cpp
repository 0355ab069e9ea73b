#include "patchlight/transport/assemble.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/form_factor/monte_carlo.h"
#include "patchlight/form_factor/patch_shape.h"
#include "patchlight/form_factor/point_polygon.h"

#include "transport/narrow.h"

#include <algorithm>
#include <cassert>
#include <vector>

namespace patchlight {
namespace {

constexpr PatchIndex edge = ExchangeAreas::edge;

// A pair of patches that face each other, and what its shadow rays have met so far.
struct Pair {
  PatchIndex first = 0;
  PatchIndex second = 0;
  bool near = false;
  double unoccluded = 0;      // exchange area without occluders, m^2
  double free_weight = 0;     // summed weights of the samples whose shadow ray is free
  double blocked_weight = 0;  // and of those whose ray is blocked
};

struct Assembler {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const AssemblyOptions& options;
  std::vector<PatchShape> shapes;
  SamplePairs samples;

  std::vector<Pair> facing_pairs(PatchIndex first, PatchRange seconds) const;
  void trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  std::vector<Pair> row(PatchIndex first, PatchRange seconds, AssemblyCounts& counts) const;
  double exchange_area(const Pair& pair, int sample_count) const;
};

std::vector<Pair> Assembler::facing_pairs(PatchIndex first, PatchRange seconds) const {
  std::vector<Pair> pairs;
  const PatchShape& shape = shapes[first];
  for (PatchIndex second = std::max(seconds.begin, first + 1); second < seconds.end; ++second) {
    if (mesh.polygon[first] == mesh.polygon[second]) continue;
    if (orientation(shape, shapes[second]) == Orientation::averted) continue;
    const double unoccluded = unoccluded_exchange_area(shape, shapes[second]);
    if (unoccluded > 0) pairs.push_back({first, second, is_near(shape, shapes[second]), unoccluded});
  }
  return pairs;
}

// Traces samples [begin, end) of every pair and adds their weights. The weight is what a sample contributes to the
// unoccluded form factor: the geometry term G, or for near patches, where G has no finite variance, the closed form
// from the sample's point to the whole other patch.
void Assembler::trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const {
  std::vector<Segment> segments;
  std::vector<double> weights;
  segments.reserve(pairs.size() * (end - begin));
  weights.reserve(segments.capacity());
  for (const Pair& pair : pairs) {
    const PatchShape& a = shapes[pair.first];
    const PatchShape& b = shapes[pair.second];
    for (std::uint32_t k = begin; k < end; ++k) {
      const auto& [u, v, s, t] = samples.at(pair.first, pair.second, k);
      const Point x = square_to_quad(a.corners.points, u, v);
      const Point y = square_to_quad(b.corners.points, s, t);
      segments.push_back({x, y, mesh.polygon[pair.first], mesh.polygon[pair.second]});
      const double geometry = geometry_term(x, a.normal, y, b.normal);
      weights.push_back(pair.near && geometry > 0 ? point_to_polygon(x, a.normal, b.corners) : geometry);
    }
  }
  const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    Pair& pair = pairs[k / (end - begin)];
    (blocked[k] ? pair.blocked_weight : pair.free_weight) += weights[k];
  }
}

// The pairs of one patch with the patches of one block, with all their shadow rays traced.
std::vector<Pair> Assembler::row(PatchIndex first, PatchRange seconds, AssemblyCounts& counts) const {
  std::vector<Pair> pairs = facing_pairs(first, seconds);
  counts.facing_pairs += pairs.size();
  counts.near_pairs +=
      static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), [](const Pair& p) { return p.near; }));
  if (pairs.empty() || !occluder.can_occlude()) return pairs;

  // 1. A few probes for every pair.
  const auto probes = static_cast<std::uint32_t>(options.probes);
  trace(pairs, 0, probes);
  counts.shadow_rays += pairs.size() * probes;

  // 2. The remaining samples where the probes disagree.
  const auto partial = [](const Pair& pair) { return pair.free_weight > 0 && pair.blocked_weight > 0; };
  const auto first_whole = std::stable_partition(pairs.begin(), pairs.end(), partial);
  const std::span<Pair> mixed(pairs.begin(), first_whole);
  const auto all = static_cast<std::uint32_t>(options.samples);
  if (!mixed.empty() && all > probes) {
    trace(mixed, probes, all);
    counts.shadow_rays += mixed.size() * (all - probes);
  }
  counts.partial_pairs += mixed.size();
  counts.blocked_pairs += static_cast<std::size_t>(std::count_if(
      first_whole, pairs.end(), [](const Pair& p) { return p.free_weight == 0 && p.blocked_weight > 0; }));
  return pairs;
}

double Assembler::exchange_area(const Pair& pair, int sample_count) const {
  if (pair.blocked_weight == 0) return pair.unoccluded;
  if (pair.free_weight == 0) return 0;
  if (pair.near) return pair.unoccluded * pair.free_weight / (pair.free_weight + pair.blocked_weight);
  // Control variate: the exact unoccluded value less the sampled blocked part, A_i A_j / s sum_k G_k (1 - V_k).
  const double blocked = shapes[pair.first].area * shapes[pair.second].area * pair.blocked_weight / sample_count;
  return std::max(0.0, pair.unoccluded - blocked);
}

// Block row and column of the k-th of all tiles of the upper triangle, long rows first.
struct Tile {
  PatchIndex I = 0;
  PatchIndex J = 0;
};

std::vector<Tile> upper_tiles(PatchIndex blocks) {
  std::vector<Tile> tiles;
  for (PatchIndex I = 0; I < blocks; ++I) {
    for (PatchIndex J = I; J < blocks; ++J) tiles.push_back({I, J});
  }
  return tiles;
}

PatchRange block(PatchIndex index, PatchIndex size) { return {index * edge, std::min(size, (index + 1) * edge)}; }

AssemblyCounts fill_tile(const Assembler& assembler, const Tile& tile, std::span<float> entries) {
  AssemblyCounts counts;
  const PatchIndex size = assembler.mesh.size();
  const PatchRange firsts = block(tile.I, size);
  const PatchRange seconds = block(tile.J, size);
  for (PatchIndex first = firsts.begin; first < firsts.end; ++first) {
    for (const Pair& pair : assembler.row(first, seconds, counts)) {
      const float area = narrow_toward_zero(assembler.exchange_area(pair, assembler.options.samples));
      const std::size_t r = pair.first % edge;
      const std::size_t c = pair.second % edge;
      entries[r * edge + c] = area;
      if (tile.I == tile.J) entries[c * edge + r] = area;
    }
  }
  return counts;
}

}  // namespace

Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const Observer& observer) {
  assert(options.probes >= 1 && options.samples >= options.probes);
  const Assembler assembler{mesh, occluder, options, patch_shapes(mesh),
                            SamplePairs(static_cast<std::uint32_t>(options.samples), options.seed)};
  Assembly result{ExchangeAreas(mesh.size()), {}};
  const std::vector<Tile> tiles = upper_tiles(result.exchange_areas.blocks());
  std::vector<AssemblyCounts> counts(tiles.size());
  parallel_for(tiles.size(), Stage::form_factors, observer, [&](std::size_t k) {
    counts[k] = fill_tile(assembler, tiles[k], result.exchange_areas.tile(tiles[k].I, tiles[k].J));
  });
  for (const AssemblyCounts& count : counts) {
    result.counts.facing_pairs += count.facing_pairs;
    result.counts.near_pairs += count.near_pairs;
    result.counts.partial_pairs += count.partial_pairs;
    result.counts.blocked_pairs += count.blocked_pairs;
    result.counts.shadow_rays += count.shadow_rays;
  }
  return result;
}

}  // namespace patchlight
