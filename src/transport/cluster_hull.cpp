#include "transport/cluster_hull.h"

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

}  // namespace patchlight
