#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with panes that are modelled as solids counting once: of two clear faces that face away from each other,
/// as the two faces of a sheet of glass do, the later one becomes clear in full, and the first has its material on both
/// sides. They have to be parallel and opposite each other corner by corner, at most 5 cm and a tenth of their own size
/// apart, and of one material that does not emit; of several that could be pairs the nearest are. A face with a
/// material on its back is a sheet already. A note says how many there are. What is cut otherwise on its two faces
/// counts face by face. O(n log n + k) for n clear faces of which k pairs are near each other.
Scene with_solid_panes_as_one(Scene scene);

}  // namespace patchlight
