#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "transport/ray_rows.h"

namespace patchlight {

class Occluder;

/// Rows of form factors for one colour: that of the clear polygons and mirrors of an occluder, which is as that by
/// which the rows were traced but for the colours. Each row sums up to what its patch sees by light of this colour.
/// Rows without stops stay as they are. No ray is traced.
TracedRows weighed_rows(TracedRows rows, const PatchMesh& mesh, const Occluder& occluder);

/// Each row as a whole times what makes its sum that of `wanted`.
void scale(RayRows& rows, const Eigen::VectorXd& wanted);

}  // namespace patchlight
