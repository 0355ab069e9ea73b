#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include "lighting/lighting.h"
#include "render/gathered_light.h"

namespace patchlight {

/// What a gather at points needs of a solved scene: the brightest lamps apart from what patches reflect. Keeps a
/// reference to the simulation, which must outlive it.
SolvedLight solved_light(const Simulation& simulation);

}  // namespace patchlight
