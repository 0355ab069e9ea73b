#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

#include <memory>
#include <vector>

namespace patchlight {

/// Which polygons can stand between two patches: those that may, all when occlusion is forced, none when it is skipped.
Occluder::Blockers blockers_of(const Plan& plan);

/// Whether light that mirrors and clear faces reflect goes on: only rows of rays follow it.
Reflections reflections_of(const Plan& plan);

/// The scene with the lights that the plan simulates; without differences of colour when these are skipped by force:
/// every spectrum is replaced by its luminance (light/photometry.h), the same in all bands.
/// Shares `scene` where that changes nothing.
std::shared_ptr<const Scene> scene_as_planned(const std::shared_ptr<const Scene>& scene, const Plan& plan);

/// The scene as sensors see it, which may stand where no patch is: only what is skipped by force gives no light.
/// Shares `scene` as well.
std::shared_ptr<const Scene> scene_for_sensors(const std::shared_ptr<const Scene>& scene, const Plan& plan);

/// The scene with a single band, that one of its own.
Scene in_one_band(Scene scene, Eigen::Index band);

/// The scene with some of its bands, in this order; their luminous weights sum up to 1 again. What is clear in some
/// band stays clear in all: where it lets nothing through, it lets the smallest share through that there is.
Scene in_bands(Scene scene, const std::vector<Eigen::Index>& bands);

}  // namespace patchlight
