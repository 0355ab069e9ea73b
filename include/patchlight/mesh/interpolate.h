#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

namespace patchlight {

/// Values at the mesh's vertices: the mean of the patches that share each vertex, weighted by `area` in m^2, which has
/// one positive entry per patch: the exposed area, so that what is covered does not darken its surroundings. Rows are
/// vertices.
Field vertex_means(const PatchMesh& mesh, const FieldView& patch_values, const Eigen::VectorXd& area);

/// A value inside a patch from the values at its vertices: barycentric in a triangle, inverse bilinear in a
/// quadrilateral. `point` is taken as its projection on the patch, clamped to it. One row, one column per band.
Eigen::Array<double, 1, Eigen::Dynamic> interpolate(const PatchMesh& mesh, const FieldView& vertex_values,
                                                    PatchIndex patch, const Point& point);

}  // namespace patchlight
