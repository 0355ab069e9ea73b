#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/transport/assemble.h"

#include "form_factor/patch_cluster.h"
#include "form_factor/patch_shape.h"
#include "transport/pair_sampler.h"
#include "visibility/occluder.h"
#include "visibility/shaft.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace patchlight {

/// What decides on the shafts of a cluster.
struct ClusterHull {
  Slabs slabs;
  std::optional<HalfSpace> behind;     ///< of a planar cluster
  std::vector<Point> corners;          ///< points whose convex hull holds all patches
  bool is_covered = false;             ///< in part, by polygons that lie on those of its patches
  bool is_clear = false;               ///< some patch is one of a clear polygon
  std::vector<PolygonIndex> polygons;  ///< of the patches
};

ClusterHull hull_of(const PatchCluster& cluster, const std::vector<PatchShape>& shapes, const ShaftCuller& culler);

/// Some patches of a cluster: bit k stands for its patch k.
using LaneMask = std::uint16_t;
inline constexpr LaneMask all_lanes = 0xffff;

/// Two clusters, or one with itself: row <= column, so that every pair of patches comes in one order only.
struct ClusterPair {
  std::size_t row = 0;
  std::size_t column = 0;
};

/// What decides on the exchange areas between two clusters.
enum class PairClass {
  averted,  ///< all are 0, as one cluster lies behind the other
  hidden,   ///< all are 0, as one polygon stands between them
  free,     ///< nothing can stand between them: the unoccluded values
  sampled   ///< shadow rays
};

/// The pairs of patches of a mesh, cluster by cluster, as the automatic estimator takes them. The exchange area of a
/// pair follows from its own two patches, whichever other pairs are asked for. Keeps references to mesh and occluder.
class ClusterPairs {
 public:
  ClusterPairs(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options);
  ClusterPairs(const ClusterPairs&) = delete;
  ClusterPairs& operator=(const ClusterPairs&) = delete;

  const std::vector<PatchShape>& shapes() const { return shapes_; }
  const std::vector<PatchCluster>& clusters() const { return clusters_; }
  const PairSampler& sampler() const { return sampler_; }

  PairClass class_of(const ClusterPair& pair) const;

  /// Calls use(i, j, unoccluded exchange area) for the pairs that face each other, i in `rows` of the row's cluster and
  /// j in `columns` of the column's; of a cluster with itself for i < j. The area is -1 where it takes
  /// PairSampler::exact() to find it.
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
      float unoccluded = row.unoccluded.at[k] * sampler_.held(i, j);
      if ((row.exact >> k & 1) != 0 || !short_cuts_.far) {
        if (orientation(shapes_[i], shapes_[j]) == Orientation::averted) continue;
        unoccluded = -1;
      }
      if (unoccluded != 0) use(i, j, unoccluded);
    }
  }
}

}  // namespace patchlight
