#include "gather/gradients.h"

#include "base/parallel.h"
#include "mesh/patches_at_vertices.h"

#include <Eigen/Dense>

namespace patchlight {
namespace {

// Keeps the fit soluble where all neighbours lie in one direction, as a share of the squared distances.
constexpr double damping = 1e-6;

}  // namespace

Field gradients(const PatchMesh& mesh, const FieldView& values) {
  const PatchesAtVertices at_vertex(mesh);
  Field found = Field::Zero(values.rows(), 3 * values.cols());
  parallel_for(mesh.size(), [&](std::size_t row) {
    // (sum d d^T) g = sum d (B_i - B_j), d the way from one centroid to the other
    const auto j = static_cast<PatchIndex>(row);
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, Eigen::Dynamic> products =
        Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, values.cols());
    for (const std::uint32_t vertex : corner_vertices(mesh, j)) {
      for (const PatchIndex i : at_vertex[vertex]) {
        if (i == j || mesh.polygon[i] != mesh.polygon[j] || mesh.side[i] != mesh.side[j]) continue;
        const Vector d = mesh.centroid[i] - mesh.centroid[j];
        squares += d * d.transpose();
        products += d * (values.row(i) - values.row(j)).matrix();
      }
    }
    const double size = squares.trace();
    if (!(size > 0)) return;
    squares += size * (mesh.normal[j] * mesh.normal[j].transpose() + damping * Eigen::Matrix3d::Identity());
    const Eigen::Matrix<double, 3, Eigen::Dynamic> gradient = squares.ldlt().solve(products);
    for (Eigen::Index band = 0; band < values.cols(); ++band)
      found.row(j).segment(3 * band, 3) = gradient.col(band).transpose().array();
  });
  return found;
}

}  // namespace patchlight
