#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include "lighting/lighting.h"
#include "render/gathered_light.h"

namespace patchlight {

/// What a gather at points needs of a solved scene: the brightest lamps apart from what patches reflect. Keeps
/// references to all three, which must outlive it.
SolvedLight solved_light(const Scene& scene, const Simulation& simulation, const Lighting& lighting);

}  // namespace patchlight
