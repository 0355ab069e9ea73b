#pragma once

#include "patchlight/plan/plan.h"

#include "plan/decide.h"
#include "visibility/occluder.h"

#include <cstddef>

// Notes on a scene and on a request that the plan carries.
namespace patchlight {

/// A note on lamps that face a surface nearer than half of `max_edge`, the longest edge of a patch: a patch counts as
/// evenly lit, so light that only falls close to the lamp would be spread over the whole patch. Looks from the middle
/// of each lamp along its normal. Empty when there are none.
Diagnostics notes_on_close_lamps(const Scene& scene, const Occluder& occluder, double max_edge);

/// Notes for a scene whose lamps may have changed since its sides were chosen: the materials that emit only from sides
/// that are left out, and how many sides `sides` would take today and are left out. Nothing when there are none.
Diagnostics notes_on_left_out_sides(const Scene& scene, const KeptSides& kept, Sides sides);

/// Notes on outlines that are finer than patches, in a mesh with edges of at most `max_edge` meters: the faces whose
/// patches follow a coarser outline, and those whose corners alone take a quarter of the `asked` patches or more, 0
/// standing for no such number.
Diagnostics notes_on_fine_outlines(const Scene& scene, const KeptSides& sides, std::size_t asked, double max_edge);

/// A note for each luminaire that lies up to 1 mm behind an opaque face towards which it shines, but not in its plane:
/// its light falls on the wrong side, as on the roof when it is a little over the ceiling. And for each that shines in
/// all directions from the plane of an opaque face: half of its light goes to either side.
Diagnostics notes_on_luminaires_behind(const Scene& scene);

/// A sun below the horizon gives no light.
Diagnostics notes_on_sun(const EffectFacts& facts);

/// Translucent sheets restrict the choice of solvers.
Diagnostics notes_on_sheets(const EffectFacts& facts);

/// The pair method ignores reflections in mirrors and glazing.
Diagnostics notes_on_pairs(const Scene& scene, const Request& request);

}  // namespace patchlight
