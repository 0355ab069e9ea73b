#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene without what is smaller than `detail` metres. Of each shell of opaque faces without a lamp, as shells_of()
/// has it:
/// - nothing, when it fits into a cube of that size;
/// - a box of six faces in its place, when the shell is closed, without a hole through it, not thicker than 1 m, and
///   has more faces; when no vertex lies farther than `detail` inside of the box, none of the box's sides is left free
///   by more than a rim of that width, and nothing else is inside. Its material is that of the faces, or a new one with
///   their mean reflectance.
/// A note tells how much of the area went and how much is boxes. Pure; O(n log n) for n corners.
Scene with_less_detail(Scene scene, double detail);

}  // namespace patchlight
