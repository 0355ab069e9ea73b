#include "accuracy/means_around.h"

#include <span>
#include <vector>

namespace patchlight {

Field means_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values) {
  std::vector<std::vector<PatchIndex>> at_vertex(mesh.vertices.size());
  const auto corners_of = [&](PatchIndex i) {
    return std::span(mesh.corners[i]).first(static_cast<std::size_t>(mesh.corner_points(i).count));
  };
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const std::uint32_t vertex : corners_of(i)) at_vertex[vertex].push_back(i);
  }
  Field means(values.rows(), values.cols());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    Field sum = Field::Zero(1, values.cols());
    double areas = 0;
    for (const std::uint32_t vertex : corners_of(i)) {
      for (const PatchIndex j : at_vertex[vertex]) {
        if (mesh.polygon[j] != mesh.polygon[i]) continue;
        sum += area[j] * values.row(j).square();
        areas += area[j];
      }
    }
    means.row(i) = (sum / areas).sqrt();
  }
  return means;
}

}  // namespace patchlight
