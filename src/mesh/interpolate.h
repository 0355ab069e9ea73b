#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>
#include <array>

namespace patchlight {

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
