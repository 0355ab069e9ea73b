#pragma once

#include "patchlight/mesh/nested_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

namespace patchlight {

/// The mesh that the plan says, nested when error bars are wanted.
NestedMesh first_mesh(const Scene& scene, const Plan& plan);

}  // namespace patchlight
