#include "form_factor/patch_cluster.h"

#include "base/target_clones.h"
#include "base/tolerances.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

namespace patchlight {
namespace {

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

// Patches by the plane they lie in and the side they face. Offsets count as shares of the unit.
std::vector<Members> by_plane(const PatchMesh& mesh, double unit) {
  std::map<std::array<std::int64_t, 4>, Members> planes;
  const auto rounded = [](double x) { return std::llround(x / tolerance_of_coordinates); };
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
  // A model larger than 10 times the root of its area has patches far away from all others, which do not count.
  const double unit = std::min(box.diagonal().norm() + shapes[0].radius,
                               10 * std::sqrt(std::accumulate(mesh.area.begin(), mesh.area.end(), 0.0)));
  Members others;
  const auto add = [&](Members& members, bool is_planar) {
    std::vector<Members> leaves;
    divide(mesh, members, leaves);
    for (const Members& leaf : leaves) clusters.push_back(cluster_of(mesh, shapes, leaf, unit, is_planar));
  };
  for (Members& members : by_plane(mesh, unit)) {
    // Fewer patches on a plane are clustered with those of other planes.
    if (members.size() >= 6) {
      add(members, true);
    } else {
      others.insert(others.end(), members.begin(), members.end());
    }
  }
  if (!others.empty()) add(others, false);
  // Sorted by patch, so that neighboring clusters write neighboring entries.
  std::sort(clusters.begin(), clusters.end(),
            [](const PatchCluster& a, const PatchCluster& b) { return a.patches[0] < b.patches[0]; });
  return clusters;
}

namespace {

// Loops over lanes are written so that the compiler turns them into vector instructions.

// Rounding in single precision leaves this share of the distance of a height.
constexpr float height_rounding = 4e-7F;

struct Float3 {
  float x, y, z;
};

PATCHLIGHT_INLINE Float3 lane_of(const LaneVectors& vectors, int lane) {
  const auto k = static_cast<std::size_t>(lane);
  return {vectors.x.at[k], vectors.y.at[k], vectors.z.at[k]};
}

PATCHLIGHT_INLINE Float3 minus(const Float3& a, const Float3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

// Adds int int cos cos' / r^4 over the pairs of quadrature points of one patch, whose points are `shift` away in the
// frame of the cluster, and each patch of the cluster.
template <int capacity>
PATCHLIGHT_INLINE void add_products(const LaneRules<capacity>& first, int lane, const Float3& normal,
                                    const Float3& shift, const LaneRules<capacity>& second, const LaneVectors& normals,
                                    Lanes& sum) {
  for (int a = 0; a < first.count; ++a) {
    const auto ka = static_cast<std::size_t>(a);
    const Float3 p = minus(lane_of(first.point[ka], lane), shift);
    const float weight = first.weight[ka].at[static_cast<std::size_t>(lane)];
    Lanes inner;
    for (int b = 0; b < second.count; ++b) {
      const auto kb = static_cast<std::size_t>(b);
      const LaneVectors& point = second.point[kb];
      for (std::size_t l = 0; l < Lanes::count; ++l) {
        const float x = point.x.at[l] - p.x;
        const float y = point.y.at[l] - p.y;
        const float z = point.z.at[l] - p.z;
        const float squared = x * x + y * y + z * z;
        const float cosine = std::max(0.0F, normal.x * x + normal.y * y + normal.z * z);
        const float other = std::max(0.0F, -(normals.x.at[l] * x + normals.y.at[l] * y + normals.z.at[l] * z));
        inner.at[l] += second.weight[kb].at[l] * cosine * other / (squared * squared);
      }
    }
    for (std::size_t l = 0; l < Lanes::count; ++l) sum.at[l] += weight * inner.at[l];
  }
}

// Per lane, the lowest and highest corner of the lane's patch over the plane of the one patch, and of the one patch
// over that of the lane's.
struct Heights {
  Lanes lowest, highest, lowest_of_one, highest_of_one;
};

PATCHLIGHT_INLINE Heights heights(const PatchCluster& first, int lane, const Float3& shift,
                                  const PatchCluster& second) {
  Heights h;
  const Float3 normal = lane_of(first.normal, lane);
  const Float3 corner0 = minus(lane_of(first.corner[0], lane), shift);
  for (std::size_t k = 0; k < 4; ++k) {
    const LaneVectors& corner = second.corner[k];
    const LaneVectors& origin = second.corner[0];
    const Float3 mine = minus(lane_of(first.corner[k], lane), shift);
    for (std::size_t l = 0; l < Lanes::count; ++l) {
      const float height = normal.x * (corner.x.at[l] - corner0.x) + normal.y * (corner.y.at[l] - corner0.y) +
                           normal.z * (corner.z.at[l] - corner0.z);
      const float of_one = second.normal.x.at[l] * (mine.x - origin.x.at[l]) +
                           second.normal.y.at[l] * (mine.y - origin.y.at[l]) +
                           second.normal.z.at[l] * (mine.z - origin.z.at[l]);
      h.lowest.at[l] = k == 0 ? height : std::min(h.lowest.at[l], height);
      h.highest.at[l] = k == 0 ? height : std::max(h.highest.at[l], height);
      h.lowest_of_one.at[l] = k == 0 ? of_one : std::min(h.lowest_of_one.at[l], of_one);
      h.highest_of_one.at[l] = k == 0 ? of_one : std::max(h.highest_of_one.at[l], of_one);
    }
  }
  return h;
}

enum class Zone : std::uint8_t { none = 0, exact = 1, middle = 2, far = 3 };

// The zone of each pair of the row.
PATCHLIGHT_INLINE void classify(const PatchCluster& first, int lane, const Float3& shift, const PatchCluster& second,
                                std::array<std::int32_t, Lanes::count>& zone) {
  const Heights h = heights(first, lane, shift, second);
  const Float3 centroid = minus(lane_of(first.centroid, lane), shift);
  const float radius = first.radius.at[static_cast<std::size_t>(lane)];
  // A coordinate and its differences are right to 1.2e-7 of the largest. Patches whose distance is not known to 1e-4,
  // as their clusters are wide against it, are left to double precision.
  const float rounding =
      1.2e-7F * (first.reach + second.reach + std::abs(shift.x) + std::abs(shift.y) + std::abs(shift.z));
  const float least = rounding * rounding / (1e-4F * 1e-4F);
  for (std::size_t l = 0; l < Lanes::count; ++l) {
    const float x = second.centroid.x.at[l] - centroid.x;
    const float y = second.centroid.y.at[l] - centroid.y;
    const float z = second.centroid.z.at[l] - centroid.z;
    const float squared = x * x + y * y + z * z;
    const float larger = std::max(radius, second.radius.at[l]);
    const float reach = squared / (4 * larger * larger);
    const float tolerance = static_cast<float>(height_tolerance) * (radius + second.radius.at[l]) +
                            height_rounding * (std::abs(x) + std::abs(y) + std::abs(z));
    const int coarse = static_cast<int>(squared < least);
    const float lowest_seen = coarse != 0 ? -rounding : tolerance;
    const int facing =
        static_cast<int>(h.highest.at[l] > lowest_seen) & static_cast<int>(h.highest_of_one.at[l] > lowest_seen);
    const int exact = coarse | static_cast<int>(reach < static_cast<float>(near_diameters * near_diameters)) |
                      static_cast<int>(h.lowest.at[l] < -tolerance) |
                      static_cast<int>(h.lowest_of_one.at[l] < -tolerance);
    const int far = static_cast<int>(reach >= static_cast<float>(far_diameters * far_diameters));
    zone[l] = facing * (exact + (1 - exact) * (2 + far));
  }
}

}  // namespace

PATCHLIGHT_TARGET_CLONES
ClusterRow cluster_row(const PatchCluster& first, int lane, const PatchCluster& second) {
  ClusterRow row;
  const Eigen::Vector3f offset = ((second.centre - first.centre) / first.unit).cast<float>();
  const Float3 shift{offset.x(), offset.y(), offset.z()};
  alignas(64) std::array<std::int32_t, Lanes::count> zone;
  classify(first, lane, shift, second, zone);
  int any_middle = 0;
  int any_far = 0;
  for (std::size_t l = 0; l < static_cast<std::size_t>(second.size); ++l) {
    row.facing = static_cast<std::uint16_t>(row.facing | static_cast<int>(zone[l] != 0) << l);
    row.exact = static_cast<std::uint16_t>(row.exact | static_cast<int>(zone[l] == 1) << l);
    any_middle |= static_cast<int>(zone[l] == 2);
    any_far |= static_cast<int>(zone[l] == 3);
  }
  const Float3 normal = lane_of(first.normal, lane);
  Lanes middle;
  Lanes far;
  if (any_middle != 0) add_products(first.fine, lane, normal, shift, second.fine, second.normal, middle);
  if (any_far != 0) add_products(first.coarse, lane, normal, shift, second.coarse, second.normal, far);
  const auto scale = static_cast<float>(first.unit * first.unit / std::numbers::pi);
  for (std::size_t l = 0; l < Lanes::count; ++l) {
    row.unoccluded.at[l] = scale * (zone[l] == 2 ? middle.at[l] : zone[l] == 3 ? far.at[l] : 0.0F);
  }
  return row;
}

bool averted(const PatchCluster& first, const PatchCluster& second) {
  const auto behind = [](const PatchCluster& plane, const PatchCluster& other) {
    if (!plane.is_planar) return false;
    const Float3 normal = lane_of(plane.normal, 0);
    const Eigen::Vector3f offset = ((other.centre - plane.centre) / plane.unit).cast<float>();
    const Float3 origin = minus(lane_of(plane.corner[0], 0), {offset.x(), offset.y(), offset.z()});
    float highest = -1;
    for (const LaneVectors& corner : other.corner) {
      for (std::size_t l = 0; l < Lanes::count; ++l) {
        highest = std::max(highest, normal.x * (corner.x.at[l] - origin.x) + normal.y * (corner.y.at[l] - origin.y) +
                                        normal.z * (corner.z.at[l] - origin.z));
      }
    }
    return highest <= height_rounding * offset.lpNorm<1>();
  };
  return behind(first, second) || behind(second, first);
}

}  // namespace patchlight
