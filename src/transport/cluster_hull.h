#pragma once

#include "form_factor/patch_cluster.h"
#include "visibility/shaft.h"

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

}  // namespace patchlight
