#include "mesh/means_around.h"

#include "base/parallel.h"
#include "mesh/patches_at_vertices.h"

namespace patchlight {

namespace {

// Normals of patches that are the same surface have a product above this one.
constexpr double same_facing = 0.9;

}  // namespace

Field mean_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values) {
  const PatchesAtVertices at_vertex(mesh);
  Field means = Field::Zero(values.rows(), values.cols());
  parallel_for(mesh.size(), [&](std::size_t at) {
    const auto i = static_cast<PatchIndex>(at);
    auto sum = means.row(i);
    double areas = 0;
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) {
      for (const PatchIndex j : at_vertex[vertex]) {
        if (mesh.normal[i].dot(mesh.normal[j]) < same_facing) continue;
        sum += area[j] * values.row(j);
        areas += area[j];
      }
    }
    sum /= areas;
  });
  return means;
}

Field means_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values) {
  return mean_around(mesh, area, values.square()).sqrt();
}

}  // namespace patchlight
