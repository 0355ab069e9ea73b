#pragma once

#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

namespace patchlight {

/// A note on lamps that face a surface nearer than half of `max_edge`, the longest edge of a patch: a patch counts as
/// evenly lit, so light that only falls close to the lamp would be spread over the whole patch. Looks from the middle
/// of each lamp along its normal. Empty when there are none.
Diagnostics notes_on_close_lamps(const Scene& scene, const Occluder& occluder, double max_edge);

}  // namespace patchlight
