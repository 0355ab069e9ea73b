#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with panes that are modelled as solids counting once: of two clear faces that face away from each other,
/// as the two faces of a sheet of glass do, the later one becomes clear in full. They have to be parallel and opposite
/// each other, with outlines of one shape, at most 5 cm and a tenth of their own size apart, and of one material that
/// neither emits nor differs between front and back. A note says how many there are. What is cut otherwise on its two
/// faces counts face by face. O(n^2) for n clear faces.
Scene with_solid_panes_as_one(Scene scene);

}  // namespace patchlight
