#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"

#include "form_factor/pair_samples.h"
#include "form_factor/patch_cluster.h"
#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"
#include "visibility/shaft.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// The pure tracing rate in shadow rays per second. Traces up to `rays` rays, at most 262,144, between random facing
/// patches, four per pair, on all threads. 0 if `rays` is too small to measure. Varies from run to run.
double bare_ray_rate(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t rays);

/// The number of rays traced together.
inline constexpr std::size_t rays_at_once = 4096;

/// A shadow ray between two patches.
struct PairSample {
  Point from;             ///< on the smaller patch
  Point to;               ///< on the larger
  double weight = 0;      ///< the mean of the weights of the free rays is the exchange area, m^2
  double unoccluded = 0;  ///< an estimate of the exchange area without occluders, m^2; 0 if it is not used
};

/// A sample with uniformly distributed points on both patches: weight A_i A_j G.
PairSample draw_by_area(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at);

/// The results of half of the shadow rays of a pair.
struct PairHalf {
  float weight = 0;                 ///< summed weights of its samples: geometry terms, 1/m^2
  float seen_weight = 0;            ///< the same, each times the transmittance of its shadow ray
  float seen = 0;                   ///< summed transmittances of samples with a weight
  float idle_seen = 0;              ///< of samples without a weight: one end lies behind the other patch
  std::uint32_t weighted_rays = 0;  ///< of samples with a weight
  std::uint32_t idle_rays = 0;      ///< of samples without

  std::uint32_t rays() const { return weighted_rays + idle_rays; }
};

/// A pair of facing patches. The first and the second half of its samples estimate its exchange area twice.
struct Pair {
  PatchIndex first = 0;  ///< rays are sampled from here
  PatchIndex second = 0;
  SampleSet set;
  std::array<PairHalf, 2> halves{};
  float unoccluded = 0;      ///< exchange area without occluders, m^2; -1 when not yet computed
  std::uint32_t effort = 1;  ///< multiple of the usual number of samples
  bool is_adjacent = false;  ///< sampled by solid angle

  std::uint32_t rays() const { return halves[0].rays() + halves[1].rays(); }
  /// The mean transmittance of its rays; if none has a weight, all count alike.
  double visible_share() const;
};

/// Samples the visibility between the patches of pairs by shadow rays.
class PairSampler {
 public:
  PairSampler(const PatchMesh& mesh, const std::vector<PatchShape>& shapes, const Occluder& occluder,
              const AssemblyOptions& options);

  /// `unoccluded` is -1 if it needs exact(), which is called when a ray is free.
  Pair new_pair(PatchIndex i, PatchIndex j, float unoccluded) const;

  /// The share of the light between two patches that counts as exchanged: the part that clear patches hold back.
  float nonspecular_fraction(PatchIndex i, PatchIndex j) const { return nonspecular_[i] * nonspecular_[j]; }

  /// The exchange area without occluders, by closed form or quadrature in double precision, times
  /// nonspecular_fraction().
  float exact(PatchIndex i, PatchIndex j) const;

  /// Traces the rays of every pair. Their number depends on the form factor, never on the hits of the first rays, so
  /// the estimate has no bias. The order of the pairs changes.
  std::vector<Pair> sampled(std::vector<Pair> pairs) const;

  /// The mean of the estimates of both halves, m^2.
  double exchange_area(const Pair& pair) const;

  /// Half of the difference of both estimates, m^2.
  double half_difference(const Pair& pair) const;

 private:
  std::array<double, 2> estimates(const Pair& pair) const;
  void trace(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  void trace_packets(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  void trace_adjacent(std::span<Pair> pairs, std::uint32_t begin, std::uint32_t end) const;
  std::uint32_t effort_for(const Pair& pair) const;

  const PatchMesh& mesh_;
  const std::vector<PatchShape>& shapes_;
  const Occluder& occluder_;
  FarRule far_rule_;
  std::uint32_t samples_;  // the usual number, even
  double scale_;
  std::vector<std::uint32_t> keys_;
  std::vector<SampledPatch> patches_;
  std::vector<float> nonspecular_;
  SampleTable table_;
};

/// The data of a cluster for shaft tests.
struct ClusterHull {
  Slabs slabs;
  std::optional<HalfSpace> behind;     ///< of a planar cluster
  std::vector<Point> corners;          ///< points whose convex hull holds all patches
  bool is_covered = false;             ///< at least partly, by polygons that lie on those of its patches
  bool is_clear = false;               ///< some patch belongs to a clear polygon
  std::vector<PolygonIndex> polygons;  ///< of the patches
};

/// A set of patches of a cluster: bit k stands for patch k.
using LaneMask = std::uint16_t;
inline constexpr LaneMask all_lanes = 0xffff;

/// Two clusters, or one with itself: row <= column, so every pair of patches has one order only.
struct ClusterPair {
  std::size_t row = 0;
  std::size_t column = 0;
};

/// How the exchange areas between two clusters are computed.
enum class PairClass {
  averted,  ///< all are 0: one cluster lies behind the other
  hidden,   ///< all are 0: one polygon hides the clusters from each other
  free,     ///< nothing can stand between them: the unoccluded values
  sampled   ///< shadow rays
};

/// The pairs of patches of a mesh by cluster, for the automatic estimator. The exchange area of a pair depends on its
/// own two patches only, not on the other requested pairs. Keeps references to mesh and occluder.
class ClusterPairs {
 public:
  ClusterPairs(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options);
  ClusterPairs(const ClusterPairs&) = delete;
  ClusterPairs& operator=(const ClusterPairs&) = delete;

  const std::vector<PatchShape>& shapes() const { return shapes_; }
  const std::vector<PatchCluster>& clusters() const { return clusters_; }
  const PairSampler& sampler() const { return sampler_; }

  PairClass class_of(const ClusterPair& pair) const;

  /// Calls use(i, j, unoccluded exchange area) for facing pairs, with i in `rows` of the row's cluster and j in
  /// `columns` of the column's; within one cluster for i < j. The area is -1 if it needs PairSampler::exact().
  template <typename Use>
  void for_facing(const ClusterPair& pair, LaneMask rows, LaneMask columns, Use use) const;

 private:
  bool is_free(const ClusterHull& a, const ClusterHull& b) const;

  const PatchMesh& mesh_;
  const Occluder& occluder_;
  ShortCuts short_cuts_;
  std::vector<PatchShape> shapes_;
  std::vector<PatchCluster> clusters_;
  std::vector<ClusterHull> hulls_;
  PairSampler sampler_;
};

template <typename Use>
void ClusterPairs::for_facing(const ClusterPair& pair, LaneMask rows, LaneMask columns, Use use) const {
  const PatchCluster& a = clusters_[pair.row];
  const PatchCluster& b = clusters_[pair.column];
  for (int lane = 0; lane < a.size; ++lane) {
    if ((rows >> lane & 1) == 0) continue;
    const ClusterRow row = cluster_row(a, lane, b);
    const PatchIndex i = a.patches[static_cast<std::size_t>(lane)];
    for (unsigned left = row.facing & columns; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const PatchIndex j = b.patches[k];
      if (mesh_.polygon[i] == mesh_.polygon[j] || (pair.row == pair.column && j <= i)) continue;
      float unoccluded = row.unoccluded.at[k] * sampler_.nonspecular_fraction(i, j);
      if ((row.exact >> k & 1) != 0 || !short_cuts_.far) {
        if (orientation(shapes_[i], shapes_[j]) == Orientation::averted) continue;
        unoccluded = -1;
      }
      if (unoccluded != 0) use(i, j, unoccluded);
    }
  }
}

}  // namespace patchlight
