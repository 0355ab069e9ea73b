#include "transport/cluster_pairs.h"

#include "visibility/occluder.h"

#include <algorithm>
#include <span>

namespace patchlight {
namespace {

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

bool is_covered(const PatchMesh& mesh, const PatchCluster& cluster, const Occluder& occluder) {
  return std::any_of(cluster.patches.begin(), cluster.patches.begin() + cluster.size,
                     [&](PatchIndex i) { return occluder.is_covered_in_part(mesh.polygon[i], mesh.side[i]); });
}

bool is_clear(const PatchMesh& mesh, const PatchCluster& cluster, const Occluder& occluder) {
  return std::any_of(cluster.patches.begin(), cluster.patches.begin() + cluster.size,
                     [&](PatchIndex i) { return occluder.held_share(mesh.polygon[i], mesh.side[i]) < 1; });
}

std::vector<PolygonIndex> polygons_of(const PatchMesh& mesh, const PatchCluster& cluster) {
  std::vector<PolygonIndex> polygons;
  for (int lane = 0; lane < cluster.size; ++lane)
    polygons.push_back(mesh.polygon[cluster.patches[static_cast<std::size_t>(lane)]]);
  std::sort(polygons.begin(), polygons.end());
  polygons.erase(std::unique(polygons.begin(), polygons.end()), polygons.end());
  return polygons;
}

}  // namespace

ClusterHull hull_of(const PatchCluster& cluster, const std::vector<PatchShape>& shapes, const ShaftCuller& culler) {
  std::vector<Point> corners;
  for (int lane = 0; lane < cluster.size; ++lane) {
    const std::span<const Point> patch = shapes[cluster.patches[static_cast<std::size_t>(lane)]].corners;
    corners.insert(corners.end(), patch.begin(), patch.end());
  }
  ClusterHull hull{culler.slabs(corners), {}, {}, false, false, {}};
  const PatchShape& first = shapes[cluster.patches[0]];
  const Vector& normal = first.normal;
  if (cluster.is_planar) {
    // Of the lowest corner: the patches lie in one plane up to rounding only.
    double lowest = normal.dot(first.centroid);
    for (const Point& corner : corners) lowest = std::min(lowest, normal.dot(corner));
    hull.behind = HalfSpace{normal, lowest};
  }
  hull.corners = box_around(corners, cluster.is_planar ? normal : Vector(Vector::UnitZ()), first.centroid);
  return hull;
}

ClusterPairs::ClusterPairs(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options)
    : mesh_(mesh),
      occluder_(occluder),
      short_cuts_(options.short_cuts),
      shapes_(patch_shapes(mesh)),
      clusters_(patch_clusters(mesh, shapes_)),
      sampler_(mesh, shapes_, occluder, options) {
  for (const PatchCluster& cluster : clusters_) {
    hulls_.push_back(hull_of(cluster, shapes_, occluder.shafts()));
    hulls_.back().is_covered = is_covered(mesh, cluster, occluder);
    hulls_.back().is_clear = is_clear(mesh, cluster, occluder);
    hulls_.back().polygons = polygons_of(mesh, cluster);
  }
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
  // What a clear polygon holds back depends on the angle, which no closed form knows.
  if (a.is_covered || b.is_covered || a.is_clear || b.is_clear) return false;
  return !occluder_.can_occlude() || occluder_.shafts().is_empty(a.slabs, b.slabs, a.behind, b.behind);
}

}  // namespace patchlight
