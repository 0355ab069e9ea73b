#pragma once

#include "patchlight/plan/effects.h"
#include "patchlight/plan/plan.h"

#include "plan/effect_facts.h"

#include <vector>

namespace patchlight {

/// Which effects are simulated, given what the scene is like and what is asked for: one decision for each of
/// simulated_effects(), and one for each effect that is not simulated and that the scene has. Pure.
/// EffectOptions::force and EffectOptions::skip overrule the facts, as long as there is something to simulate: a sun
/// that is not there cannot be forced.
std::vector<Decision> decide(const EffectFacts& facts, const Request& request);

/// The decision about closure where form factors are rows of rays.
Decision closed_by_rays();

/// A note on every effect that is to be forced or skipped and of which the scene has nothing.
Diagnostics notes_on_overruling(const EffectFacts& facts, const Request& request);

}  // namespace patchlight
