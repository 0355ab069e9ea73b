#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "mesh/nested_mesh.h"
#include "visibility/occluder.h"

namespace patchlight {

/// The kept sides of the polygons in patches with edges of `max_edge` metres at most that end at the plan's lines of
/// contact. What of them lies whole under another face, or inside of a solid that stands on its polygon, as sixteen
/// places on each tell, is left out.
PatchMesh open_patches(const Scene& scene, const Plan& plan, double max_edge, const Occluder& occluder);

/// The same for whoever has no occluder: one is made where the plan has lines of contact, and only there.
PatchMesh open_patches(const Scene& scene, const Plan& plan, double max_edge);

/// The mesh that the plan says, nested when error bars are wanted.
NestedMesh first_mesh(const Scene& scene, const Plan& plan, const Occluder& occluder);

/// The same for whoever has no occluder.
NestedMesh first_mesh(const Scene& scene, const Plan& plan);

}  // namespace patchlight
