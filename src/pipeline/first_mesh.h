#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "mesh/nested_mesh.h"

namespace patchlight {

/// The mesh that the plan says, nested when error bars are wanted.
NestedMesh first_mesh(const Scene& scene, const Plan& plan);

}  // namespace patchlight
