#include "form_factor/patch_cluster.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <tuple>

namespace patchlight {
namespace {

// Planes that differ by less count as one; share of the unit, and of 1 for the normals.
constexpr double plane_resolution = 1e-6;

// On a plane with fewer patches than this, clusters are made with those of other planes.
constexpr std::size_t least_on_plane = 6;

// A model is no larger than so many times the root of its area, or some of it lies far away.
constexpr double roomy = 10;

using Members = std::vector<PatchIndex>;

void set(LaneVectors& vectors, std::size_t lane, const Vector& value) {
  vectors.x.at[lane] = static_cast<float>(value.x());
  vectors.y.at[lane] = static_cast<float>(value.y());
  vectors.z.at[lane] = static_cast<float>(value.z());
}

template <int capacity>
void set(LaneRules<capacity>& rules, std::size_t lane, const Quadrature<capacity>& rule, const PatchCluster& cluster) {
  rules.count = std::max(rules.count, rule.count);
  for (std::size_t k = 0; k < capacity; ++k) {
    // Spare points lie where the first is.
    const std::size_t from = k < static_cast<std::size_t>(rule.count) ? k : 0;
    set(rules.point[k], lane, (Point(rule.x[from], rule.y[from], rule.z[from]) - cluster.centre) / cluster.unit);
    rules.weight[k].at[lane] = from == k ? static_cast<float>(rule.weight[k] / (cluster.unit * cluster.unit)) : 0.0F;
  }
}

PatchCluster cluster_of(const PatchMesh& mesh, const std::vector<PatchShape>& shapes, const Members& members,
                        double unit, bool is_planar) {
  PatchCluster cluster;
  cluster.size = static_cast<int>(members.size());
  cluster.is_planar = is_planar;
  cluster.unit = unit;
  Box box;
  for (const PatchIndex patch : members) box.extend(mesh.centroid[patch]);
  cluster.centre = box.center();
  for (std::size_t lane = 0; lane < Lanes::count; ++lane) {
    // Spare lanes repeat the last patch.
    const PatchIndex patch = members[std::min(lane, members.size() - 1)];
    const PatchShape& shape = shapes[patch];
    cluster.patches[lane] = patch;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t corner = std::min(k, static_cast<std::size_t>(shape.corners.count) - 1);
      const Vector position = (shape.corners.points[corner] - cluster.centre) / unit;
      set(cluster.corner[k], lane, position);
      cluster.reach = std::max(cluster.reach, static_cast<float>(position.lpNorm<Eigen::Infinity>()));
    }
    set(cluster.centroid, lane, (shape.centroid - cluster.centre) / unit);
    set(cluster.normal, lane, shape.normal);
    cluster.radius.at[lane] = static_cast<float>(shape.radius / unit);
    set(cluster.coarse, lane, shape.coarse, cluster);
    set(cluster.fine, lane, shape.fine, cluster);
  }
  return cluster;
}

// Halves the members along the longest side of their bounds until they fit into clusters; all but the last of a plane
// are full.
void divide(const PatchMesh& mesh, std::span<PatchIndex> members, std::vector<Members>& leaves) {
  if (members.size() <= Lanes::count) {
    leaves.emplace_back(members.begin(), members.end());
    std::sort(leaves.back().begin(), leaves.back().end());
    return;
  }
  Box box;
  for (const PatchIndex patch : members) box.extend(mesh.centroid[patch]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t full = (members.size() + Lanes::count - 1) / Lanes::count;
  const std::size_t half = full / 2 * Lanes::count;
  std::nth_element(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(half), members.end(),
                   [&](PatchIndex a, PatchIndex b) {
                     return std::tuple(mesh.centroid[a][axis], a) < std::tuple(mesh.centroid[b][axis], b);
                   });
  divide(mesh, members.first(half), leaves);
  divide(mesh, members.subspan(half), leaves);
}

// Patches by the plane they lie in and the side they face.
std::vector<Members> by_plane(const PatchMesh& mesh, double unit) {
  std::map<std::array<std::int64_t, 4>, Members> planes;
  const auto rounded = [](double x) { return std::llround(x / plane_resolution); };
  const Point origin = mesh.centroid[0];
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Vector& n = mesh.normal[i];
    const double offset = n.dot(mesh.centroid[i] - origin) / unit;
    planes[{rounded(n.x()), rounded(n.y()), rounded(n.z()), rounded(offset)}].push_back(i);
  }
  std::vector<Members> lists;
  for (auto& [plane, members] : planes) lists.push_back(std::move(members));
  return lists;
}

}  // namespace

std::vector<PatchCluster> patch_clusters(const PatchMesh& mesh, const std::vector<PatchShape>& shapes) {
  std::vector<PatchCluster> clusters;
  if (mesh.size() == 0) return clusters;
  Box box;
  for (const PatchShape& shape : shapes) box.extend(shape.centroid);
  // Patches far away from all others do not make it larger.
  const double unit = std::min(box.diagonal().norm() + shapes[0].radius,
                               roomy * std::sqrt(std::accumulate(mesh.area.begin(), mesh.area.end(), 0.0)));
  Members others;
  const auto add = [&](Members& members, bool is_planar) {
    std::vector<Members> leaves;
    divide(mesh, members, leaves);
    for (const Members& leaf : leaves) clusters.push_back(cluster_of(mesh, shapes, leaf, unit, is_planar));
  };
  for (Members& members : by_plane(mesh, unit)) {
    if (members.size() >= least_on_plane) {
      add(members, true);
    } else {
      others.insert(others.end(), members.begin(), members.end());
    }
  }
  if (!others.empty()) add(others, false);
  // In the order of the patches, so that neighbouring clusters write neighbouring entries.
  std::sort(clusters.begin(), clusters.end(),
            [](const PatchCluster& a, const PatchCluster& b) { return a.patches[0] < b.patches[0]; });
  return clusters;
}

}  // namespace patchlight
