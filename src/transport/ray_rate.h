#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "visibility/occluder.h"

#include <cstdint>

namespace patchlight {

/// Shadow rays per second that the occluder traces when nothing else is done: at most `rays` of them, and at most
/// 262,144, between random patches that face each other, four to a pair, on all threads. What an assembly reaches of
/// this is its efficiency. 0 when `rays` are too few to tell. Differs from run to run.
double bare_ray_rate(const PatchMesh& mesh, const Occluder& occluder, std::uint64_t rays);

}  // namespace patchlight
