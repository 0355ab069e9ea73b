#pragma once

#include "patchlight/simulate.h"

#include "pipeline/world.h"

namespace patchlight {

/// The plan's notes, those on polygons that lie one on the other and, where patches are not refined, on lamps that are
/// close to what they light: else error bars see these.
Diagnostics notes_on_run(const World& world, const Plan& plan);

/// Of patches with known form factors those that emit, and lie over what they lay under when these were made, as a lamp
/// that is let into a ceiling and was dark then.
Diagnostics notes_on_hidden_lamps(const Scene& scene, const Simulation& simulation);

}  // namespace patchlight
