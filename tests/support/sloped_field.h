#pragma once

#include "mesh/interpolate.h"

#include <Eigen/QR>
#include <algorithm>
#include <cstddef>
#include <span>

// Fields that are linear on every patch, as references between meshes whose patches do not match.
namespace patchlight::test {

/// A field that is linear on every patch.
struct SlopedField {
  Field values;  ///< the means of the patches
  Field slopes;  ///< three columns for each of `values`: the gradient, per meter
};

/// As much of a slope as keeps the corners of patch i between these values around the mean.
inline Eigen::Vector3d limited(const Eigen::Vector3d& slope, const PatchMesh& mesh, PatchIndex i, double least,
                               double most) {
  double share = 1;
  const PatchCorners corners = mesh.corner_points(i);
  for (const Point& corner : std::span<const Point>(corners)) {
    const double rise = slope.dot(corner - mesh.centroid[i]);
    if (rise > most) share = std::min(share, most / rise);
    if (rise < least) share = std::min(share, least / rise);
  }
  return share * slope;
}

/// A field with slopes by least squares from the means of the surrounding patches: those on the same polygon side that
/// share a corner. No corner exceeds the range of these patches (Barth and Jespersen, AIAA 89-0366), so a non-negative
/// field stays non-negative.
inline SlopedField with_slopes(const PatchMesh& mesh, const FieldView& values) {
  const PatchesAtVertices at_vertex(mesh);
  SlopedField field{values, Field::Zero(values.rows(), 3 * values.cols())};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    // Least squares over the patches around; without a slope across the patch.
    Eigen::Matrix3d moments = mesh.area[i] * mesh.normal[i] * mesh.normal[i].transpose();
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(3, values.cols());
    Field least = values.row(i);
    Field most = values.row(i);
    for (const std::uint32_t vertex : corner_vertices(mesh, i)) {
      for (const PatchIndex j : at_vertex[vertex]) {
        if (mesh.polygon[j] != mesh.polygon[i] || mesh.side[j] != mesh.side[i]) continue;
        const Vector way = mesh.centroid[j] - mesh.centroid[i];
        moments += way * way.transpose();
        right += way * (values.row(j) - values.row(i)).matrix();
        least = least.min(values.row(j));
        most = most.max(values.row(j));
      }
    }
    const Eigen::MatrixXd slope = moments.completeOrthogonalDecomposition().solve(right);
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      field.slopes.row(i).segment(3 * c, 3) =
          limited(slope.col(c), mesh, i, least(0, c) - values(i, c), most(0, c) - values(i, c)).transpose();
    }
  }
  return field;
}

/// The means of such a field of `other` over the patches of `mesh`. They depend on the relative position of both meshes
/// only through the curvature of the field.
inline Field average_over(const PatchMesh& mesh, const PatchMesh& other, const SlopedField& field) {
  const Eigen::Index columns = field.values.cols();
  return patchlight::average_over(mesh, other, columns, [&](PatchIndex k, const Point& point) {
    const Vector offset = point - other.centroid[k];
    Field value = field.values.row(k);
    for (Eigen::Index c = 0; c < columns; ++c)
      value(0, c) += field.slopes.row(k).segment(3 * c, 3).matrix().dot(offset);
    return value;
  });
}

}  // namespace patchlight::test
