#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include "form_factor/patch_shape.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// One number for each patch of a cluster: as many as one AVX-512 register holds.
struct alignas(64) Lanes {
  static constexpr int count = 16;
  std::array<float, count> at{};
};

/// One vector for each patch of a cluster.
struct LaneVectors {
  Lanes x, y, z;
};

/// A quadrature rule for each patch of a cluster; unused points have weight 0.
template <int capacity>
struct LaneRules {
  std::array<LaneVectors, capacity> point;
  std::array<Lanes, capacity> weight;
  int count = 0;
};

/// A group of nearby patches, arranged so that form factors with all of them are computed together in single precision.
/// Lengths are divided by `unit` and positions are relative to `centre`, so that rounding is small compared with the
/// cluster's size.
struct PatchCluster {
  int size = 0;
  std::array<PatchIndex, Lanes::count> patches{};
  bool is_planar = false;  ///< all patches lie in one plane and face the same side of it: that of the first patch
  Point centre;            ///< meters
  double unit = 1;         ///< meters; about the extent of the mesh
  float reach = 0;         ///< largest coordinate of a corner: rounding is 6e-8 of it
  std::array<LaneVectors, 4> corner;
  LaneVectors centroid;
  LaneVectors normal;
  Lanes radius;  ///< of the circle around the centroid that holds the corners
  LaneRules<4> coarse;
  LaneRules<9> fine;
};

/// Groups all patches into clusters: by plane if a plane has enough patches, the others by place. O(size log size).
std::vector<PatchCluster> patch_clusters(const PatchMesh& mesh, const std::vector<PatchShape>& shapes);

/// One patch against all patches of a cluster. Bit k of a mask stands for the cluster's patch k.
struct ClusterRow {
  Lanes unoccluded;          ///< exchange areas without occluders, m^2; for facing pairs that are not in `exact`
  std::uint16_t facing = 0;  ///< pairs whose form factor is not 0 by orientation
  std::uint16_t exact = 0;   ///< facing pairs that need unoccluded_exchange_area(): near or straddling ones, or ones in
                             ///< clusters too wide for single precision
};

/// The exchange areas of patch `lane` of cluster `first` with the patches of `second`. Relative error below 3e-3 by the
/// quadrature of unoccluded_exchange_area(), and 1e-6 by rounding.
ClusterRow cluster_row(const PatchCluster& first, int lane, const PatchCluster& second);

/// True when no patch of one cluster can see any of the other, because all of one lie behind or in the plane of the
/// other. Always false unless a cluster is planar.
bool averted(const PatchCluster& first, const PatchCluster& second);

}  // namespace patchlight
