#pragma once

#include "verify/path_scene.h"
#include "verify/path_tracer.h"
#include "visibility/occluder.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// For each point of a receiver 1 when it is exposed, 0 when it is covered: inside a solid, or against another face. A
/// point is covered when another polygon lies over it in its plane, or when each of eight cosine-distributed rays and
/// each of eight around its horizon meets a side that is not kept, or a face that lies against the receiver.
std::vector<std::uint8_t> exposed(const Occluder& occluder, const Surfaces& surfaces, const PathReceiver& receiver,
                                  std::span<const Point> points, std::uint64_t seed);

}  // namespace patchlight
