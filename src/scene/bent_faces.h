#pragma once

#include "patchlight/scene/scene.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// Per polygon 1 where its corners, or those of a polygon that it shares one with, are farther from lying in one plane
/// than touching faces may be apart, weld_distance(), as coordinates far from the origin in single precision have it:
/// nobody knows what touches it.
std::vector<std::uint8_t> bent_faces(const Scene& scene);

}  // namespace patchlight
