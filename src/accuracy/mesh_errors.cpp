#include "patchlight/accuracy/error_bars.h"

#include <cassert>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

// Means over the patches of the same polygon side that share a vertex, the patch itself among them.
Field means_around(const PatchMesh& mesh, const Field& values) {
  std::vector<std::vector<PatchIndex>> at_vertex(mesh.vertices.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (int k = 0; k < mesh.corner_points(i).count; ++k) {
      at_vertex[mesh.corners[i][static_cast<std::size_t>(k)]].push_back(i);
    }
  }
  Field means(values.rows(), values.cols());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    Field sum = Field::Zero(1, values.cols());
    double count = 0;
    for (int k = 0; k < mesh.corner_points(i).count; ++k) {
      for (const PatchIndex j : at_vertex[mesh.corners[i][static_cast<std::size_t>(k)]]) {
        if (mesh.polygon[j] != mesh.polygon[i]) continue;
        sum += values.row(j).square();
        ++count;
      }
    }
    means.row(i) = (sum / count).sqrt();
  }
  return means;
}

}  // namespace

Field mesh_errors(const PatchMesh& coarse, const Field& coarse_radiosity, const SolvedMesh& fine, double order) {
  assert(fine.mesh.size() == 4 * coarse.size());
  const double scale = 1 / (std::pow(2.0, order) - 1);
  Field error(coarse_radiosity.rows(), coarse_radiosity.cols());
  for (Eigen::Index i = 0; i < error.rows(); ++i) {
    const auto area = fine.area.segment(4 * i, 4).array();
    const Field mean = (fine.radiosity.middleRows(4 * i, 4).colwise() * area).colwise().sum() / area.sum();
    error.row(i) = scale * (mean - coarse_radiosity.row(i)).abs();
  }
  const Field around = means_around(coarse, error);
  Field bars(fine.radiosity.rows(), fine.radiosity.cols());
  for (Eigen::Index i = 0; i < bars.rows(); ++i) bars.row(i) = error.row(i / 4).max(around.row(i / 4));
  return bars;
}

}  // namespace patchlight
