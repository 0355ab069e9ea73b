#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "mesh/nested_mesh.h"
#include "visibility/occluder.h"

namespace patchlight {

/// Cuts the kept sides of the polygons into patches with edges of at most `max_edge` meters, which end at the plan's
/// lines of contact. Leaves out patches that lie completely under another face, or inside a solid that stands on their
/// polygon. Sixteen points per patch decide.
PatchMesh open_patches(const Scene& scene, const Plan& plan, double max_edge, const Occluder& occluder);

/// The same without a given occluder: builds one if the plan has lines of contact.
PatchMesh open_patches(const Scene& scene, const Plan& plan, double max_edge);

/// The first mesh of the plan, nested if the plan has error bars.
NestedMesh first_mesh(const Scene& scene, const Plan& plan, const Occluder& occluder);

/// The same without a given occluder.
NestedMesh first_mesh(const Scene& scene, const Plan& plan);

}  // namespace patchlight
