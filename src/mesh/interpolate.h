#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace patchlight {

/// The vertices of a patch's three or four corners.
std::span<const std::uint32_t> corner_vertices(const PatchMesh& mesh, PatchIndex patch);

/// The patches that have a corner at each vertex, in their order.
class PatchesAtVertices {
 public:
  explicit PatchesAtVertices(const PatchMesh& mesh);

  std::span<const PatchIndex> operator[](std::size_t vertex) const {
    return std::span(patches_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::size_t> first_;  // per vertex; one more at the end
  std::vector<PatchIndex> patches_;
};

/// Means, by the areas given in m^2, over a patch and the patches that share a vertex with it and face as it does,
/// within 25 degrees.
Field mean_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values);

/// Root mean squares over the same patches.
Field means_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values);

/// Means over the patches of `mesh` of a field that is constant on every patch of `other`. `values` has one row per
/// patch of `other`; row i of the result is sum_k O_ik x_k / sum_k O_ik. O_ik is the area in which two patches overlap.
/// Both meshes have the same sides of the same polygons; either may be the finer one. For partly covered patches, the
/// mean over the exposed part is average_over(share x) / average_over(share). The result does not depend on the number
/// of threads. Costs about n + n' log n' + n sqrt(n') per side of a polygon.
Field average_over(const PatchMesh& mesh, const PatchMesh& other, const FieldView& values);

/// The same for a field that varies within the patches of `other`: value(k, point), a row with this number of columns,
/// in the middle of the common part with each patch k.
Field average_over(const PatchMesh& mesh, const PatchMesh& other, Eigen::Index columns,
                   const std::function<Field(PatchIndex, const Point&)>& value);

/// Weight of each patch (row) at each of its corners (column); the fourth of a triangle is not used.
using CornerWeights = Eigen::Array<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// Values at the mesh's vertices: the mean of the patches that share each vertex, weighted by their weights there. 0 at
/// a vertex without any weight; on the edge of a patch that is not cut there, the mean of those at its ends. Rows are
/// vertices.
Field vertex_means(const PatchMesh& mesh, const FieldView& patch_values, const CornerWeights& weights);

/// The weights, not negative and of sum 1, with which the corners of a patch contribute to a point in it: barycentric
/// in a triangle, inverse bilinear in a quadrilateral. `point` is taken as its projection on the patch, clamped to it.
std::array<double, 4> interpolation_weights(const PatchMesh& mesh, PatchIndex patch, const Point& point);

/// The value inside a patch from the values at the mesh's vertices and such weights. One row, one column per band.
Eigen::Array<double, 1, Eigen::Dynamic> interpolate(const PatchMesh& mesh, const FieldView& vertex_values,
                                                    PatchIndex patch, const std::array<double, 4>& weights);

}  // namespace patchlight
