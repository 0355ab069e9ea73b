#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace patchlight {

/// 1 for each patch of a material, object or group with one of these names, else 0; without names 1 for all.
Eigen::VectorXd interest_of(const Scene& scene, const PatchMesh& mesh, const std::vector<std::string>& names);

/// \throws InputError when nothing in the scene has one of the names.
void require_names(const Scene& scene, const std::vector<std::string>& names);

}  // namespace patchlight
