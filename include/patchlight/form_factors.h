#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/transport/exchange.h"

namespace patchlight {

/// The form factors between the patches of a scene.
struct FormFactors {
  Request request;  ///< with its defaults filled in
  Plan plan;
  PatchMesh mesh;
  Exchange exchange;
  Diagnostics notes = {};  ///< on overlapping polygons
};

/// The first half of simulate(), for a scene that need not have a lamp: without one Sides::automatic means the front
/// sides. Computes and keeps all form factors for every value of AssemblyOptions::storage. Closed exchange areas are
/// stored as floats; their rounding changes row sums by less than 1e-7 of the area. Exchange that is not closed keeps
/// the errors of its entries where closure weighs by them. \throws InputError, MemoryError, Canceled.
FormFactors find_form_factors(const Scene& scene, const Request& request, const Observer& observer = {});

}  // namespace patchlight
