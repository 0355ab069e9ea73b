#include "gather/planes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cstddef>

namespace patchlight {

std::vector<PatchIndex> PlaneFits::patches_around(PatchIndex j) const {
  std::vector<PatchIndex> around;
  for (const std::uint32_t vertex : corner_vertices(mesh_, j)) {
    for (const PatchIndex i : at_vertex_[vertex]) {
      if (i != j && mesh_.polygon[i] == mesh_.polygon[j] && mesh_.side[i] == mesh_.side[j]) around.push_back(i);
    }
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

std::vector<PatchIndex> PlaneFits::in_sight(PatchIndex j, std::span<const PatchIndex> others) const {
  std::vector<Segment> segments;
  for (const PatchIndex i : others) {
    const Vector up = 0.1 * (mesh_.centroid[i] - mesh_.centroid[j]).norm() * mesh_.normal[j];
    segments.push_back({mesh_.centroid[j] + up, mesh_.centroid[i] + up});
  }
  const std::vector<float> arriving = occluder_.transmittance(segments);
  std::vector<PatchIndex> found;
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (arriving[k] > 0) found.push_back(others[k]);
  }
  return found;
}

Eigen::Matrix3Xd PlaneFits::slopes(PatchIndex j, std::span<const PatchIndex> around) const {
  Eigen::Matrix3Xd ways(3, static_cast<Eigen::Index>(around.size()));
  for (std::size_t k = 0; k < around.size(); ++k)
    ways.col(static_cast<Eigen::Index>(k)) = mesh_.centroid[around[k]] - mesh_.centroid[j];
  Eigen::Matrix3d squares = ways * ways.transpose();
  const double size = squares.trace();
  if (!(size > 0)) return Eigen::Matrix3Xd::Zero(3, ways.cols());
  // The damping of 1e-6 keeps the matrix regular where the patches lie on one line.
  squares += size * (mesh_.normal[j] * mesh_.normal[j].transpose() + 1e-6 * Eigen::Matrix3d::Identity());
  return squares.ldlt().solve(ways);
}

}  // namespace patchlight
