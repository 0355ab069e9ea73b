#include "patchlight/transport/assemble.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/form_factor/monte_carlo.h"
#include "patchlight/form_factor/patch_keys.h"
#include "patchlight/form_factor/patch_shape.h"
#include "patchlight/form_factor/solid_angle.h"

#include "transport/narrow.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

constexpr PatchIndex edge = ExchangeAreas::edge;

// Near pairs are few and weigh much: they get this many times the samples of others.
constexpr std::uint32_t near_factor = 4;

// A pair of patches that face each other, and what its shadow rays have met so far.
struct Pair {
  PatchIndex first = 0;
  PatchIndex second = 0;
  bool near = false;
  double unoccluded = 0;      // exchange area without occluders, m^2
  double free_weight = 0;     // summed weights of the samples whose shadow ray is free
  double blocked_weight = 0;  // and of those whose ray is blocked
  int free_rays = 0;
  int blocked_rays = 0;
};

struct PairSample {
  Segment shadow_ray;
  double weight = 0;
};

struct Assembler {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const AssemblyOptions& options;
  std::vector<PatchShape> shapes;
  std::vector<std::uint32_t> keys;
  SamplePairs samples;

  std::vector<Pair> facing_pairs(PatchIndex first, PatchRange seconds) const;
  std::array<PatchIndex, 2> ordered(const Pair& pair) const;
  PairSample sample(const Pair& pair, std::uint32_t k) const;
  void trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  std::vector<Pair> row(PatchIndex first, PatchRange seconds, AssemblyCounts& counts) const;
  double exchange_area(const Pair& pair) const;
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

// The two patches of a pair in an order that does not depend on their numbers: near pairs the smaller first, else by
// key.
std::array<PatchIndex, 2> Assembler::ordered(const Pair& pair) const {
  const double first = shapes[pair.first].area;
  const double second = shapes[pair.second].area;
  const bool sizes_differ = std::abs(first - second) > 1e-9 * (first + second);
  const bool swap = pair.near && sizes_differ ? second < first : keys[pair.second] < keys[pair.first];
  return swap ? std::array{pair.second, pair.first} : std::array{pair.first, pair.second};
}

// Sample k of a pair: its shadow ray, and its weight, the mean of which is the unoccluded exchange area.
PairSample Assembler::sample(const Pair& pair, std::uint32_t k) const {
  const auto [i, j] = ordered(pair);
  const PatchShape& a = shapes[i];
  const PatchShape& b = shapes[j];
  const auto& [u, v, s, t] = samples.at(keys[i], keys[j], k);
  const Point x = square_to_quad(a.corners.points, u, v);
  if (!pair.near) {
    const Point y = square_to_quad(b.corners.points, s, t);
    return {{x, y, mesh.polygon[i], mesh.polygon[j]}, a.area * b.area * geometry_term(x, a.normal, y, b.normal)};
  }
  // Near patches by solid angle, as the geometry term has no finite variance there.
  const PolygonSample y = sample_solid_angle(x, a.normal, b.corners, s, t);
  return {{x, y.weight > 0 ? y.point : b.centroid, mesh.polygon[i], mesh.polygon[j]}, a.area * y.weight};
}

// Traces samples [begin, end) of every pair and adds up their weights.
void Assembler::trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const {
  std::vector<Segment> segments;
  std::vector<double> weights;
  segments.reserve(pairs.size() * (end - begin));
  weights.reserve(segments.capacity());
  for (const Pair& pair : pairs) {
    for (std::uint32_t k = begin; k < end; ++k) {
      const PairSample next = sample(pair, k);
      segments.push_back(next.shadow_ray);
      weights.push_back(next.weight);
    }
  }
  const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    Pair& pair = pairs[k / (end - begin)];
    (blocked[k] ? pair.blocked_weight : pair.free_weight) += weights[k];
    ++(blocked[k] ? pair.blocked_rays : pair.free_rays);
  }
}

// The pairs of one patch with the patches of one block, with all their shadow rays traced.
std::vector<Pair> Assembler::row(PatchIndex first, PatchRange seconds, AssemblyCounts& counts) const {
  std::vector<Pair> pairs = facing_pairs(first, seconds);
  counts.facing_pairs += pairs.size();
  counts.near_pairs +=
      static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), [](const Pair& p) { return p.near; }));
  if (pairs.empty() || !occluder.can_occlude()) return pairs;

  // 1. A few probes for every pair, all samples for near pairs.
  const auto probes = static_cast<std::uint32_t>(options.probes);
  const auto all = static_cast<std::uint32_t>(options.samples);
  const auto near_end = std::stable_partition(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.near; });
  trace({pairs.begin(), near_end}, 0, near_factor * all);
  trace({near_end, pairs.end()}, 0, probes);

  // 2. The remaining samples where the probes disagree.
  const auto partial = [](const Pair& pair) { return (pair.free_weight > 0) == (pair.blocked_weight > 0); };
  const auto mixed_end = std::stable_partition(near_end, pairs.end(), partial);
  trace({near_end, mixed_end}, probes, all);

  const auto near = static_cast<std::uint64_t>(near_end - pairs.begin());
  const auto mixed = static_cast<std::uint64_t>(mixed_end - near_end);
  counts.shadow_rays += (near * near_factor + mixed) * all + (pairs.size() - near - mixed) * probes;
  const auto count = [&](const auto& condition) {
    return static_cast<std::uint64_t>(std::count_if(pairs.begin(), pairs.end(), condition));
  };
  counts.partial_pairs += count(partial);
  counts.blocked_pairs += count([](const Pair& p) { return p.free_weight == 0 && p.blocked_weight > 0; });
  return pairs;
}

double Assembler::exchange_area(const Pair& pair) const {
  if (pair.blocked_rays == 0) return pair.unoccluded;
  if (pair.free_rays == 0) return 0;
  // Of patches that see each other in a small part only, no sample may lie in it: then all rays count alike.
  if (pair.free_weight + pair.blocked_weight == 0) {
    return pair.unoccluded * pair.free_rays / (pair.free_rays + pair.blocked_rays);
  }
  // What is mostly hidden is estimated directly; what is mostly seen by the control variate, the exact unoccluded value
  // less the mean of what is blocked. Either way the error is that of the smaller part.
  const double count = options.samples * (pair.near ? static_cast<double>(near_factor) : 1.0);
  if (pair.free_weight < pair.blocked_weight) return std::min(pair.unoccluded, pair.free_weight / count);
  return std::max(0.0, pair.unoccluded - pair.blocked_weight / count);
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
      const float area = narrow_toward_zero(assembler.exchange_area(pair));
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
  const Assembler assembler{mesh,
                            occluder,
                            options,
                            patch_shapes(mesh),
                            patch_keys(mesh),
                            SamplePairs(near_factor * static_cast<std::uint32_t>(options.samples), options.seed)};
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
