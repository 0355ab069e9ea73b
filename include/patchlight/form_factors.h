#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/transport/exchange.h"

namespace patchlight {

/// The form factors between the patches of a scene.
struct FormFactors {
  Request request;  ///< as it was carried out
  Plan plan;
  PatchMesh mesh;
  Exchange exchange;
  Diagnostics notes = {};  ///< on polygons that lie one on the other
};

/// The first half of simulate(), for a scene that need not have a lamp: without one Sides::automatic means the front
/// sides. All form factors are computed and kept, whatever AssemblyOptions::storage says. What the storage of closed
/// exchange areas as floats takes from the rows, below 1e-7 of the area, is left out. What is not closed keeps the
/// errors of its entries where closure will weigh by them. \throws InputError, MemoryError, Cancelled.
FormFactors find_form_factors(const Scene& scene, const Request& request, const Observer& observer = {});

}  // namespace patchlight
