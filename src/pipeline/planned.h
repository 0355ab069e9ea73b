#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include "visibility/tracing.h"

namespace patchlight {

/// make_plan() for a run of which some steps are done otherwise: form factors that are known are a matrix, even where
/// the rows of the lamps would do. They are known neither on demand nor with error bars, for which no mesh may be given
/// either.
Plan planned(const Scene& scene, const Request& request, const Steps& with);

/// The plan with notes on polygons that lie one on the other and, where patches are not refined, on lamps that are
/// close to what they light: else error bars see these.
Plan with_notes_on(const Scene& scene, const Tracing& tracing, const Request& request, Plan plan);

}  // namespace patchlight
