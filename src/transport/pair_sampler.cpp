#include "transport/pair_sampler.h"

#include "patchlight/transport/half_differences.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "base/tolerances.h"
#include "form_factor/point_polygon.h"
#include "transport/tiles.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t rays_per_pair = 4;
constexpr std::size_t packets_per_task = 64;

// Packets as those of an assembly with few samples: pairs of one patch with patches that follow each other.
struct PacketMaker {
  const PatchMesh& mesh;
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  const SampleTable table{rays_per_pair, 1};
  TracingFrame frame;

  ShadowPacket packet(std::uint32_t number) const {
    // Patches that do not face each other are drawn again, a few times.
    PatchIndex i = 0;
    PatchIndex j = 0;
    for (std::uint32_t draw = 0; draw < 16; ++draw) {
      i = hash({number, draw, 0}) % mesh.size();
      j = hash({number, draw, 1}) % mesh.size();
      if (orientation(shapes[i], shapes[j]) != Orientation::averted) break;
    }
    PairSamples samples;
    const SampledPatch from = sampled_patch(shapes[i], mesh.polygon[i], frame);
    for (std::size_t n = 0; n < ShadowPacket::size / rays_per_pair; ++n) {
      const auto second = static_cast<PatchIndex>((j + n) % mesh.size());
      const SampledPatch to = sampled_patch(shapes[second], mesh.polygon[second], frame);
      add_samples(samples, static_cast<int>(n * rays_per_pair), static_cast<int>(rays_per_pair), from, to,
                  table.of_pair(i, second), 0, frame.scale);
    }
    return samples.rays;
  }
};

}  // namespace

double bare_ray_rate(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t rays) {
  const std::size_t tasks = std::min<std::uint64_t>(rays, 262144) / ShadowPacket::size / packets_per_task;
  if (tasks == 0 || mesh.size() < 2) return 0;
  const PacketMaker maker{.mesh = mesh, .frame = occluder.frame()};
  std::vector<ShadowPacket> made(tasks * packets_per_task);
  parallel_for(made.size(), [&](std::size_t k) { made[k] = maker.packet(static_cast<std::uint32_t>(k)); });

  std::vector<std::uint32_t> blocked(tasks);
  const double start = wall_seconds();
  parallel_for(tasks, [&](std::size_t task) {
    for (std::size_t k = 0; k < packets_per_task; ++k) {
      blocked[task] += occluder.occluded(made[task * packets_per_task + k]);
    }
  });
  const double seconds = wall_seconds() - start;
  return seconds > 0 ? static_cast<double>(made.size() * ShadowPacket::size) / seconds : 0;
}

namespace {

// Both halves have equally many samples.
std::uint32_t even(int count) { return (static_cast<std::uint32_t>(std::max(count, 1)) + 1) / 2 * 2; }

// `let_through` is the share of the light along the ray that arrives.
void add(PairHalf& half, float weight, float let_through) {
  const bool idle = !(weight > 0);
  half.weight += weight;
  half.seen_weight += weight * let_through;
  (idle ? half.idle_seen : half.seen) += let_through;
  ++(idle ? half.idle_rays : half.weighted_rays);
}

// The half of sample k of `count`.
PairHalf& half_of(Pair& pair, std::size_t k, std::size_t count) { return pair.halves[2 * k < count ? 0 : 1]; }

PairHalf all_of(const Pair& pair) {
  const auto& [a, b] = pair.halves;
  return {a.weight + b.weight,       a.seen_weight + b.seen_weight,     a.seen + b.seen,
          a.idle_seen + b.idle_seen, a.weighted_rays + b.weighted_rays, a.idle_rays + b.idle_rays};
}

// Calls use(group) for the pairs that are sampled in one way and get equally many rays.
template <typename Use>
void for_groups(std::span<Pair> pairs, Use use) {
  const auto key = [](const Pair& p) { return std::make_pair(p.is_adjacent, p.effort); };
  std::stable_sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) { return key(a) < key(b); });
  for (std::size_t first = 0, end = 0; first < pairs.size(); first = end) {
    while (end < pairs.size() && key(pairs[end]) == key(pairs[first])) ++end;
    use(pairs.subspan(first, end - first));
  }
}

std::vector<float> nonspecular_fractions(const PatchMesh& mesh, const Occluder& occluder) {
  std::vector<float> nonspecular;
  nonspecular.reserve(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i)
    nonspecular.push_back(static_cast<float>(occluder.optics().nonspecular_fraction(mesh.polygon[i], mesh.side[i])));
  return nonspecular;
}

std::vector<SampledPatch> sampled_patches(const PatchMesh& mesh, const std::vector<PatchShape>& shapes,
                                          const TracingFrame& frame) {
  std::vector<SampledPatch> patches;
  patches.reserve(mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) patches.push_back(sampled_patch(shapes[i], mesh.polygon[i], frame));
  return patches;
}

}  // namespace

PairSample draw_by_area(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at) {
  const Point x = square_to_quad(smaller.corners.points, at[0], at[1]);
  const Point y = square_to_quad(larger.corners.points, at[2], at[3]);
  return {x, y, smaller.area * larger.area * geometry_term(x, smaller.normal, y, larger.normal), 0};
}

double Pair::visible_share() const {
  const PairHalf all = all_of(*this);
  const bool idle = all.weighted_rays == 0;
  return static_cast<double>(idle ? all.idle_seen : all.seen) / std::max(1U, idle ? all.idle_rays : all.weighted_rays);
}

PairSampler::PairSampler(const PatchMesh& mesh, const std::vector<PatchShape>& shapes, const Occluder& occluder,
                         const AssemblyOptions& options)
    : mesh_(mesh),
      shapes_(shapes),
      occluder_(occluder),
      far_rule_(options.short_cuts.far ? FarRule::coarse : FarRule::fine),
      samples_(even(options.samples)),
      scale_(occluder.frame().scale),
      keys_(patch_keys(mesh)),
      patches_(sampled_patches(mesh, shapes, occluder.frame())),
      nonspecular_(nonspecular_fractions(mesh, occluder)),
      table_(most_effort * samples_, options.seed) {}

float PairSampler::exact(PatchIndex i, PatchIndex j) const {
  return narrow_toward_zero(static_cast<double>(nonspecular_fraction(i, j)) *
                            unoccluded_exchange_area(shapes_[i], shapes_[j], far_rule_));
}

// The two patches come in an order that does not depend on their numbers: of adjacent pairs the smaller first, else by
// key.
Pair PairSampler::new_pair(PatchIndex i, PatchIndex j, float unoccluded) const {
  const bool adjacent = is_adjacent(shapes_[i], shapes_[j]);
  const double first = shapes_[i].area;
  const double second = shapes_[j].area;
  const bool sizes_differ = std::abs(first - second) > tolerance_of_shapes * (first + second);
  if (adjacent && sizes_differ ? second < first : keys_[j] < keys_[i]) std::swap(i, j);
  return {.first = i,
          .second = j,
          .set = table_.of_pair(keys_[i], keys_[j]),
          .unoccluded = unoccluded,
          .is_adjacent = adjacent};
}

// Traces samples [begin, end) of every pair. A packet holds 2, 4, 8 or 16 rays of each of its pairs, so that its rays
// are coherent.
void PairSampler::trace_packets(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const {
  PairSamples next;
  for (std::uint32_t k = begin; k < end;) {
    std::uint32_t step = 16;
    while (step > 2 && (k % step != 0 || end - k < step)) step /= 2;
    const std::size_t at_once = ShadowPacket::size / step;
    for (std::size_t p = 0; p < pairs.size(); p += at_once) {
      for (std::size_t n = 0; n < at_once; ++n) {
        // Lanes beyond the last pair repeat it.
        const Pair& pair = pairs[std::min(p + n, pairs.size() - 1)];
        add_samples(next, static_cast<int>(n * step), static_cast<int>(step), patches_[pair.first],
                    patches_[pair.second], pair.set, k, scale_);
      }
      const auto arriving = occluder_.transmittance(next.rays);
      for (std::size_t lane = 0; lane < ShadowPacket::size && p + lane / step < pairs.size(); ++lane) {
        add(half_of(pairs[p + lane / step], k + lane % step, end), next.weight[lane], arriving[lane]);
      }
    }
    k += step;
  }
}

// The same for adjacent pairs: by solid angle, as the geometry term has no finite variance there.
void PairSampler::trace_adjacent(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const {
  const std::size_t count = end - begin;
  if (pairs.size() > 1 && pairs.size() * count > rays_at_once) {
    trace_adjacent(pairs.first(pairs.size() / 2), begin, end);
    return trace_adjacent(pairs.subspan(pairs.size() / 2), begin, end);
  }
  std::vector<Segment> segments;
  std::vector<float> weights;
  segments.reserve(pairs.size() * count);
  weights.reserve(pairs.size() * count);
  for (const Pair& pair : pairs) {
    const PatchShape& a = shapes_[pair.first];
    const PatchShape& b = shapes_[pair.second];
    for (std::size_t k = begin; k < end; ++k) {
      const auto at = [&](std::size_t d) {
        return static_cast<double>(shifted(pair.set.net[d * pair.set.stride + k], pair.set.shift[d]));
      };
      const Point x = square_to_quad(a.corners.points, at(0), at(1));
      const PolygonSample y = sample_solid_angle(x, a.normal, b.corners, at(2), at(3));
      segments.push_back(
          {x, y.weight > 0 ? y.point : b.centroid, mesh_.polygon[pair.first], mesh_.polygon[pair.second]});
      weights.push_back(static_cast<float>(y.weight / b.area));
    }
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  for (std::size_t k = 0; k < segments.size(); ++k)
    add(half_of(pairs[k / count], begin + k % count, end), weights[k], arriving[k]);
}

// Samples [begin, end) of pairs that are sampled in one way; none when there are that many already.
void PairSampler::trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const {
  if (pairs.empty() || begin >= end) return;
  if (pairs.front().is_adjacent) return trace_adjacent(pairs, begin, end);
  trace_packets(pairs, begin, end);
}

// Uses the form factor from the smaller patch, or its estimate by the weights of the first samples. If none of these
// has a weight, because the patches see each other in a sliver, the effort is the largest.
std::uint32_t PairSampler::effort_for(const Pair& pair) const {
  const PairHalf all = all_of(pair);
  if (all.weighted_rays == 0) return most_effort;
  const double first = shapes_[pair.first].area;
  const double second = shapes_[pair.second].area;
  const double mean_weight = static_cast<double>(all.weight) / all.rays();
  const double unoccluded = pair.unoccluded >= 0 ? static_cast<double>(pair.unoccluded) : first * second * mean_weight;
  return sampling_effort(unoccluded / std::min(first, second));
}

std::vector<Pair> PairSampler::sampled(std::vector<Pair> pairs) const {
  // 1. The usual number of samples for every pair.
  const auto others = std::partition(pairs.begin(), pairs.end(), [](const Pair& p) { return p.is_adjacent; });
  trace({pairs.begin(), others}, 0, samples_);
  trace({others, pairs.end()}, 0, samples_);

  // 2. More where the form factor is large. All samples so far then belong to the first half.
  for (Pair& pair : pairs) {
    pair.effort = effort_for(pair);
    if (pair.effort > 1) pair.halves = {all_of(pair), PairHalf{}};
  }
  const auto usual = std::partition(pairs.begin(), pairs.end(), [](const Pair& p) { return p.effort > 1; });
  for_groups({pairs.begin(), usual},
             [&](std::span<Pair> group) { trace(group, samples_, group.front().effort * samples_); });

  // 3. The exact value is not worth computing for pairs that see nothing of each other.
  for (Pair& pair : pairs) {
    if (pair.unoccluded < 0 && pair.visible_share() > 0) pair.unoccluded = exact(pair.first, pair.second);
  }
  return pairs;
}

// docs/theory/occluded-form-factors.md, formula (5). Single halves may leave the range from 0 to U.
std::array<double, 2> PairSampler::estimates(const Pair& pair) const {
  const double share = pair.visible_share();
  if (share == 0) return {0, 0};
  const double U = pair.unoccluded;
  const auto& [one, other] = pair.halves;
  const double m = one.weighted_rays + other.weighted_rays;
  if (m == 0) return {U * one.idle_seen / one.idle_rays, U * other.idle_seen / other.idle_rays};
  if (share == 1 || m == 1) return {share * U, share * U};
  // U minus the mean weight has the expectation 0: a control variate. It is multiplied by the visible share of the
  // other samples, from which it is independent, and removes the scatter of the weights. With the same samples it would
  // add a bias.
  const auto nonspecular_of_both = static_cast<double>(nonspecular_fraction(pair.first, pair.second));
  const double areas = nonspecular_of_both * shapes_[pair.first].area * shapes_[pair.second].area;
  const double seen = one.seen + other.seen;
  const auto of_half = [&](const PairHalf& half) {
    const double free = areas * half.seen_weight;
    const double by_others = (seen * (half.weighted_rays * U - areas * half.weight) - half.seen * U + free) / (m - 1);
    return (free + by_others + half.idle_rays * share * U) / half.rays();
  };
  return {of_half(one), of_half(other)};
}

double PairSampler::exchange_area(const Pair& pair) const {
  const auto [one, other] = estimates(pair);
  // A clear patch may scatter or absorb all light at some angle.
  const auto nonspecular_of_both = static_cast<double>(nonspecular_fraction(pair.first, pair.second));
  return std::clamp(0.5 * (one + other), 0.0, std::max(0.0, pair.unoccluded / nonspecular_of_both));
}

double PairSampler::half_difference(const Pair& pair) const {
  const auto [one, other] = estimates(pair);
  return 0.5 * (one - other);
}

namespace {

// The corners of the box around some points that has one side across `axis`: four when they lie in one plane across it.
std::vector<Point> box_around(std::span<const Point> points, const Vector& axis, const Point& origin) {
  Eigen::Matrix3d axes;
  axes.col(2) = axis;
  axes.col(0) = axis.unitOrthogonal();
  axes.col(1) = axis.cross(axes.col(0));
  Box box;
  for (const Point& point : points) box.extend(axes.transpose() * (point - origin));
  const bool is_flat = box.sizes().z() < tolerance_of_shapes * box.sizes().norm();
  std::vector<Point> corners;
  for (int k = 0; k < (is_flat ? 4 : 8); ++k) {
    corners.push_back(origin + axes * box.corner(static_cast<Box::CornerType>(k)));
  }
  return corners;
}

ClusterHull hull_of(const PatchCluster& cluster, const PatchMesh& mesh, const std::vector<PatchShape>& shapes,
                    const Occluder& occluder) {
  std::vector<Point> corners;
  ClusterHull hull;
  for (const PatchIndex i : std::span(cluster.patches).first(static_cast<std::size_t>(cluster.size))) {
    const std::span<const Point> patch = shapes[i].corners;
    corners.insert(corners.end(), patch.begin(), patch.end());
    hull.is_covered |= occluder.is_covered_in_part(mesh.polygon[i], mesh.side[i]);
    hull.is_clear |= occluder.optics().nonspecular_fraction(mesh.polygon[i], mesh.side[i]) < 1;
    hull.polygons.push_back(mesh.polygon[i]);
  }
  hull.slabs = occluder.shafts().slabs(corners);
  const PatchShape& first = shapes[cluster.patches[0]];
  const Vector& normal = first.normal;
  if (cluster.is_planar) {
    // The plane passes through the lowest corner: the patches lie in one plane up to rounding only.
    double lowest = normal.dot(first.centroid);
    for (const Point& corner : corners) lowest = std::min(lowest, normal.dot(corner));
    hull.behind = HalfSpace{normal, lowest};
  }
  hull.corners = box_around(corners, cluster.is_planar ? normal : Vector(Vector::UnitZ()), first.centroid);
  return hull;
}

}  // namespace

ClusterPairs::ClusterPairs(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options)
    : mesh_(mesh),
      occluder_(occluder),
      short_cuts_(options.short_cuts),
      shapes_(patch_shapes(mesh)),
      clusters_(patch_clusters(mesh, shapes_)),
      sampler_(mesh, shapes_, occluder, options) {
  for (const PatchCluster& cluster : clusters_) hulls_.push_back(hull_of(cluster, mesh, shapes_, occluder));
}

PairClass ClusterPairs::class_of(const ClusterPair& pair) const {
  if (averted(clusters_[pair.row], clusters_[pair.column])) return PairClass::averted;
  const ClusterHull& a = hulls_[pair.row];
  const ClusterHull& b = hulls_[pair.column];
  if (short_cuts_.free && is_free(a, b)) return PairClass::free;
  if (!short_cuts_.hidden) return PairClass::sampled;
  std::vector<PolygonIndex> own = a.polygons;
  own.insert(own.end(), b.polygons.begin(), b.polygons.end());
  return occluder_.hides(a.corners, b.corners, own) ? PairClass::hidden : PairClass::sampled;
}

bool ClusterPairs::is_free(const ClusterHull& a, const ClusterHull& b) const {
  // The share that a clear polygon holds back depends on the angle, which no closed form knows.
  if (a.is_covered || b.is_covered || a.is_clear || b.is_clear) return false;
  return !occluder_.can_occlude() || occluder_.shafts().is_empty(a.slabs, b.slabs, a.behind, b.behind);
}

}  // namespace patchlight
