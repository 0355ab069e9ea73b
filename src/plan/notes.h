#pragma once

#include "patchlight/plan/plan.h"

#include "plan/decide.h"
#include "visibility/occluder.h"

#include <cstddef>

// Notes on a scene and on a request that the plan carries.
namespace patchlight {

/// A note on lamps that face a surface nearer than half of `max_edge`, the longest edge of a patch. A patch counts as
/// evenly lit, so it would spread light that falls only near the lamp. Rays look from the middle of each lamp along its
/// normal. Empty when there are none.
Diagnostics notes_on_close_lamps(const Scene& scene, const Occluder& occluder, double max_edge);

/// Notes for a scene whose lamps may have changed since its sides were chosen. They list the materials that emit only
/// from left-out sides, and the number of left-out sides that `sides` would choose now. Empty when there are none.
Diagnostics notes_on_left_out_sides(const Scene& scene, const KeptSides& kept, Sides sides);

/// Notes on outlines finer than patches, in a mesh with edges of at most `max_edge` meters. They list the faces whose
/// patches follow a coarser outline, and those whose corners alone take a quarter of the `asked` patches or more. 0
/// stands for no requested number.
Diagnostics notes_on_fine_outlines(const Scene& scene, const KeptSides& sides, std::size_t asked, double max_edge);

/// A note for each luminaire up to 1 mm behind an opaque face towards which it shines, but not in its plane: its light
/// falls on the wrong side. For example, a luminaire just above the ceiling lights the roof. A second note lists
/// luminaires that shine in all directions from the plane of an opaque face: half of the light goes to either side.
Diagnostics notes_on_luminaires_behind(const Scene& scene);

/// A sun below the horizon gives no light.
Diagnostics notes_on_sun(const EffectFacts& facts);

/// Translucent sheets restrict the choice of solvers.
Diagnostics notes_on_sheets(const EffectFacts& facts);

/// The pair method ignores reflections in mirrors and glazing.
Diagnostics notes_on_pairs(const Scene& scene, const Request& request);

}  // namespace patchlight
