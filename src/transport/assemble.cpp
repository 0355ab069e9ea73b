#include "patchlight/transport/assemble.h"

#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/form_factor/pair_samples.h"
#include "patchlight/form_factor/patch_cluster.h"
#include "patchlight/form_factor/patch_keys.h"
#include "patchlight/form_factor/solid_angle.h"
#include "patchlight/visibility/shaft.h"

#include "transport/narrow.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

// Adjacent pairs are few and weigh much: they get this many times the samples of others.
constexpr std::uint32_t adjacent_factor = 4;

constexpr std::size_t packet = ShadowPacket::size;

// A pair of patches that face each other, and what its shadow rays have met so far.
struct Pair {
  PatchIndex first = 0;  // rays are sampled from here
  PatchIndex second = 0;
  SampleSet set;
  float unoccluded = 0;      // exchange area without occluders, m^2; -1 when not yet computed
  float free_weight = 0;     // summed weights of the samples whose shadow ray is free: geometry terms, 1/m^2
  float blocked_weight = 0;  // and of those whose ray is blocked
  std::uint16_t free_rays = 0;
  std::uint16_t blocked_rays = 0;
  bool is_adjacent = false;  // sampled by solid angle

  bool is_partial() const { return free_rays > 0 && blocked_rays > 0; }
};

// A cluster with what decides on its shafts.
struct ClusterFacts {
  Slabs slabs;
  std::optional<HalfSpace> behind;  // of a planar cluster
  std::vector<Point> hull;          // points whose convex hull holds all patches
};

struct Assembler {
  const PatchMesh& mesh;
  const Occluder& occluder;
  const AssemblyOptions& options;
  std::uint32_t probes;
  std::uint32_t samples;
  TracingFrame frame;
  std::vector<PatchShape> shapes;
  std::vector<std::uint32_t> keys;
  std::vector<SampledPatch> sampled;
  std::vector<PatchCluster> clusters;
  std::vector<ClusterFacts> facts;
  SampleTable table;

  template <typename Use>
  void for_facing_pairs(const PatchCluster& a, const PatchCluster& b, AssemblyCounts& counts, Use use) const;
  Pair new_pair(PatchIndex i, PatchIndex j, float unoccluded) const;
  void trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  void trace_adjacent(std::span<Pair> pairs, std::size_t begin, std::size_t end) const;
  float exact(PatchIndex i, PatchIndex j) const;
  void sample(std::vector<Pair>& pairs, AssemblyCounts& counts) const;
  double exchange_area(const Pair& pair) const;
  AssemblyCounts fill_row(std::size_t row, ExchangeAreas& S) const;
};

// Calls use(i, j, unoccluded exchange area) for the pairs of two clusters that face each other; the area is -1 where it
// takes exact() to find it.
template <typename Use>
void Assembler::for_facing_pairs(const PatchCluster& a, const PatchCluster& b, AssemblyCounts& counts, Use use) const {
  for (int lane = 0; lane < a.size; ++lane) {
    const ClusterRow row = cluster_row(a, lane, b);
    const PatchIndex i = a.patches[static_cast<std::size_t>(lane)];
    for (unsigned left = row.facing; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const PatchIndex j = b.patches[k];
      if (mesh.polygon[i] == mesh.polygon[j] || (&a == &b && j <= i)) continue;
      float unoccluded = row.unoccluded.at[k];
      if ((row.exact >> k & 1) != 0) {
        if (orientation(shapes[i], shapes[j]) == Orientation::averted) continue;
        unoccluded = -1;
        counts.near_pairs += is_near(shapes[i], shapes[j]) ? 1 : 0;
      }
      if (unoccluded == 0) continue;
      ++counts.facing_pairs;
      use(i, j, unoccluded);
    }
  }
}

float Assembler::exact(PatchIndex i, PatchIndex j) const {
  return narrow_toward_zero(unoccluded_exchange_area(shapes[i], shapes[j]));
}

// The two patches come in an order that does not depend on their numbers: of adjacent pairs the smaller first, else by
// key.
Pair Assembler::new_pair(PatchIndex i, PatchIndex j, float unoccluded) const {
  const bool adjacent = is_adjacent(shapes[i], shapes[j]);
  const double first = shapes[i].area;
  const double second = shapes[j].area;
  const bool sizes_differ = std::abs(first - second) > 1e-9 * (first + second);
  if (adjacent && sizes_differ ? second < first : keys[j] < keys[i]) std::swap(i, j);
  return {.first = i,
          .second = j,
          .set = table.of_pair(keys[i], keys[j]),
          .unoccluded = unoccluded,
          .is_adjacent = adjacent};
}

void add(Pair& pair, float weight, bool blocked) {
  (blocked ? pair.blocked_weight : pair.free_weight) += weight;
  ++(blocked ? pair.blocked_rays : pair.free_rays);
}

// Traces samples [begin, end) of every pair and adds up their weights. A packet holds 2, 4, 8 or 16 rays of each of its
// pairs, so that its rays are coherent.
void Assembler::trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const {
  PairSamples next;
  for (std::uint32_t k = begin; k < end;) {
    const std::size_t step = k % 16 == 0 && end - k >= 16 ? 16
                             : k % 8 == 0 && end - k >= 8 ? 8
                             : k % 4 == 0 && end - k >= 4 ? 4
                                                          : 2;
    const std::size_t at_once = packet / step;
    for (std::size_t p = 0; p < pairs.size(); p += at_once) {
      for (std::size_t n = 0; n < at_once; ++n) {
        // Lanes beyond the last pair repeat it.
        const Pair& pair = pairs[std::min(p + n, pairs.size() - 1)];
        add_samples(next, static_cast<int>(n * step), static_cast<int>(step), sampled[pair.first], sampled[pair.second],
                    pair.set, k, frame.scale);
      }
      const unsigned blocked = occluder.occluded(next.rays);
      for (std::size_t lane = 0; lane < packet && p + lane / step < pairs.size(); ++lane) {
        add(pairs[p + lane / step], next.weight[lane], (blocked >> lane & 1) != 0);
      }
    }
    k += static_cast<std::uint32_t>(step);
  }
}

// The same for adjacent pairs: by solid angle, as the geometry term has no finite variance there.
void Assembler::trace_adjacent(std::span<Pair> pairs, std::size_t begin, std::size_t end) const {
  const std::size_t count = end - begin;
  std::vector<Segment> segments;
  std::vector<float> weights;
  segments.reserve(pairs.size() * count);
  weights.reserve(pairs.size() * count);
  for (const Pair& pair : pairs) {
    const PatchShape& a = shapes[pair.first];
    const PatchShape& b = shapes[pair.second];
    for (std::size_t k = begin; k < end; ++k) {
      const auto at = [&](std::size_t d) { return static_cast<double>(pair.set.square[d * pair.set.stride + k]); };
      const Point x = square_to_quad(a.corners.points, at(0), at(1));
      const PolygonSample y = sample_solid_angle(x, a.normal, b.corners, at(2), at(3));
      segments.push_back({x, y.weight > 0 ? y.point : b.centroid, mesh.polygon[pair.first], mesh.polygon[pair.second]});
      weights.push_back(static_cast<float>(y.weight / b.area));
    }
  }
  const std::vector<std::uint8_t> blocked = occluder.occluded(segments);
  for (std::size_t k = 0; k < segments.size(); ++k) add(pairs[k / count], weights[k], blocked[k] != 0);
}

// Traces the shadow rays of some pairs.
void Assembler::sample(std::vector<Pair>& pairs, AssemblyCounts& counts) const {
  // 1. A few probes for every pair.
  const auto others = std::partition(pairs.begin(), pairs.end(), [](const Pair& p) { return p.is_adjacent; });
  trace_adjacent({pairs.begin(), others}, 0, adjacent_factor * probes);
  trace({others, pairs.end()}, 0, probes);

  // 2. The remaining samples where the probes disagree.
  const auto is_partial = [](const Pair& pair) { return pair.is_partial(); };
  const auto adjacent = std::partition(pairs.begin(), others, is_partial);
  trace_adjacent({pairs.begin(), adjacent}, adjacent_factor * probes, adjacent_factor * samples);
  const auto unanimous = std::partition(others, pairs.end(), is_partial);
  trace({others, unanimous}, probes, samples);

  for (Pair& pair : pairs) {
    counts.shadow_rays += static_cast<std::uint64_t>(pair.free_rays + pair.blocked_rays);
    counts.partial_pairs += pair.is_partial() ? 1 : 0;
    counts.blocked_pairs += pair.free_rays == 0 ? 1 : 0;
    if (pair.unoccluded < 0 && pair.free_rays > 0) pair.unoccluded = exact(pair.first, pair.second);
  }
}

double Assembler::exchange_area(const Pair& pair) const {
  if (pair.blocked_rays == 0) return pair.unoccluded;
  if (pair.free_rays == 0) return 0;
  const double count = pair.free_rays + pair.blocked_rays;
  const double areas = shapes[pair.first].area * shapes[pair.second].area;
  // Of patches that see each other in a small part only, no sample may lie in it: then all rays count alike.
  if (pair.free_weight + pair.blocked_weight == 0) return pair.unoccluded * pair.free_rays / count;
  // What is mostly hidden is estimated directly; what is mostly seen by the control variate, the exact unoccluded value
  // less the mean of what is blocked. Either way the error is that of the smaller part.
  if (pair.free_weight < pair.blocked_weight)
    return std::min<double>(pair.unoccluded, areas * pair.free_weight / count);
  return std::max(0.0, pair.unoccluded - areas * pair.blocked_weight / count);
}

// The entries of one cluster with itself and all later ones.
AssemblyCounts Assembler::fill_row(std::size_t row, ExchangeAreas& S) const {
  AssemblyCounts counts;
  const PatchCluster& a = clusters[row];
  std::vector<Pair> pairs;
  for (std::size_t column = row; column < clusters.size(); ++column) {
    const PatchCluster& b = clusters[column];
    if (averted(a, b)) continue;
    if (!occluder.can_occlude() ||
        occluder.shafts().is_empty(facts[row].slabs, facts[column].slabs, facts[row].behind, facts[column].behind)) {
      for_facing_pairs(a, b, counts, [&](PatchIndex i, PatchIndex j, float unoccluded) {
        S.set(i, j, unoccluded < 0 ? exact(i, j) : unoccluded);
        ++counts.free_pairs;
      });
      continue;
    }
    if (occluder.hides(facts[row].hull, facts[column].hull)) {
      counts.hidden_pairs += static_cast<std::uint64_t>(a.size) * static_cast<std::uint64_t>(b.size);
      continue;
    }
    pairs.clear();
    for_facing_pairs(a, b, counts, [&](PatchIndex i, PatchIndex j, float unoccluded) {
      pairs.push_back(new_pair(i, j, unoccluded));
    });
    sample(pairs, counts);
    for (const Pair& pair : pairs) S.set(pair.first, pair.second, narrow_toward_zero(exchange_area(pair)));
  }
  return counts;
}

// The corners of the box around some points that has one side across `axis`: four when they lie in one plane across it.
std::vector<Point> box_around(std::span<const Point> points, const Vector& axis, const Point& origin) {
  Eigen::Matrix3d axes;
  axes.col(2) = axis;
  axes.col(0) = axis.unitOrthogonal();
  axes.col(1) = axis.cross(axes.col(0));
  Box box;
  for (const Point& point : points) box.extend(axes.transpose() * (point - origin));
  const bool is_flat = box.sizes().z() < 1e-9 * box.sizes().norm();
  std::vector<Point> corners;
  for (int k = 0; k < (is_flat ? 4 : 8); ++k) {
    corners.push_back(origin + axes * box.corner(static_cast<Box::CornerType>(k)));
  }
  return corners;
}

ClusterFacts facts_of(const PatchCluster& cluster, const PatchMesh& mesh, const std::vector<PatchShape>& shapes,
                      const ShaftCuller& culler) {
  std::vector<Point> corners;
  for (int lane = 0; lane < cluster.size; ++lane) {
    const std::span<const Point> patch = shapes[cluster.patches[static_cast<std::size_t>(lane)]].corners;
    corners.insert(corners.end(), patch.begin(), patch.end());
  }
  ClusterFacts facts{culler.slabs(corners), {}, {}};
  const PatchIndex first = cluster.patches[0];
  const Vector& normal = mesh.normal[first];
  if (cluster.is_planar) facts.behind = HalfSpace{normal, normal.dot(mesh.centroid[first])};
  facts.hull = box_around(corners, cluster.is_planar ? normal : Vector(Vector::UnitZ()), mesh.centroid[first]);
  return facts;
}

// Numbers of samples that fill packets: 2, 4, 8 or a multiple of 16.
std::uint32_t in_packets(int count) {
  const auto wanted = static_cast<std::uint32_t>(count);
  return wanted <= 2 ? 2 : wanted <= 4 ? 4 : wanted <= 8 ? 8 : (wanted + 15) / 16 * 16;
}

}  // namespace

Assembly assemble_exchange_areas(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                                 const Observer& observer) {
  assert(options.probes >= 1 && options.samples >= options.probes);
  const TracingFrame frame = occluder.frame();
  std::vector<PatchShape> shapes = patch_shapes(mesh);
  std::vector<SampledPatch> sampled;
  for (PatchIndex i = 0; i < mesh.size(); ++i) sampled.push_back(sampled_patch(shapes[i], mesh.polygon[i], frame));
  std::vector<PatchCluster> clusters = patch_clusters(mesh, shapes);
  std::vector<ClusterFacts> facts;
  for (const PatchCluster& cluster : clusters) facts.push_back(facts_of(cluster, mesh, shapes, occluder.shafts()));
  const std::uint32_t samples = in_packets(options.samples);
  const Assembler assembler{mesh,
                            occluder,
                            options,
                            in_packets(options.probes),
                            samples,
                            frame,
                            std::move(shapes),
                            patch_keys(mesh),
                            std::move(sampled),
                            std::move(clusters),
                            std::move(facts),
                            SampleTable(adjacent_factor * samples, options.seed)};
  Assembly result{ExchangeAreas(mesh.size()), {}};
  std::vector<AssemblyCounts> counts(assembler.clusters.size());
  parallel_for(counts.size(), Stage::form_factors, observer,
               [&](std::size_t row) { counts[row] = assembler.fill_row(row, result.exchange_areas); });
  for (const AssemblyCounts& count : counts) {
    result.counts.facing_pairs += count.facing_pairs;
    result.counts.near_pairs += count.near_pairs;
    result.counts.hidden_pairs += count.hidden_pairs;
    result.counts.free_pairs += count.free_pairs;
    result.counts.partial_pairs += count.partial_pairs;
    result.counts.blocked_pairs += count.blocked_pairs;
    result.counts.shadow_rays += count.shadow_rays;
  }
  return result;
}

}  // namespace patchlight
