#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "visibility/tracing.h"

#include <string>
#include <vector>

namespace patchlight {

/// The plan's notes, those on polygons that lie one on the other and, where patches are not refined, on lamps that are
/// close to what they light: else error bars see these.
std::vector<std::string> notes_on_run(const Scene& scene, const Tracing& tracing, const Plan& plan);

}  // namespace patchlight
