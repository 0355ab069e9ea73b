#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "mesh/interpolate.h"
#include "visibility/occluder.h"

#include <Eigen/Core>

namespace patchlight {

/// Patch values as a smooth field, for display and for values at points.
struct SmoothField {
  Field at_vertices;  ///< one row per vertex of the mesh
  CornerWeights
      weights;  ///< of each patch at its corners: 0 where a wall stands between the corner and the patch's centre
};

/// Means at the vertices, weighted by `area` in m^2, the exposed area of each patch. A patch does not contribute to a
/// corner that its centre cannot see along the surface: so the two sides of a wall that stands on a patch do not mix,
/// and light does not leak farther than the patch.
SmoothField smooth(const PatchMesh& mesh, const FieldView& patch_values, const Eigen::VectorXd& area,
                   const Occluder& occluder);

/// The smooth field at a point of a patch. Where a wall stands on the patch, from those corners that the point can see.
Eigen::Array<double, 1, Eigen::Dynamic> value_at(const PatchMesh& mesh, const SmoothField& field,
                                                 const Occluder& occluder, PatchIndex patch, const Point& point);

}  // namespace patchlight
