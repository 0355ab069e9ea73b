#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>

namespace patchlight {

/// Means, by the areas given in m^2, over the patches that share a vertex with a patch and face as it does, within 25
/// degrees, itself among them: of a curved or triangulated surface as well.
Field mean_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values);

/// Root mean squares over the same patches.
Field means_around(const PatchMesh& mesh, const Eigen::VectorXd& area, const FieldView& values);

}  // namespace patchlight
