#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "visibility/occluder.h"

#include <memory>
#include <vector>

namespace patchlight {

/// The polygons that can stand between two patches: all when occlusion is forced, none when it is skipped.
Occluder::Blockers blockers_of(const Plan& plan);

/// Whether rays follow the light that mirrors and clear faces reflect. Only the ray method does.
Reflections reflections_of(const Plan& plan);

/// The scene with the lights that the plan simulates. If differences of color are skipped by force, every spectrum is
/// replaced by its luminance (light/photometry.h), the same in all bands. Shares `scene` where nothing changes.
std::shared_ptr<const Scene> scene_as_planned(const std::shared_ptr<const Scene>& scene, const Plan& plan);

/// The scene for sensors, which may stand where no patch is: only lights that are skipped by force are left out. Shares
/// `scene` where nothing changes.
std::shared_ptr<const Scene> scene_for_sensors(const std::shared_ptr<const Scene>& scene, const Plan& plan);

/// The scene with one of its bands.
Scene in_one_band(Scene scene, Eigen::Index band);

/// The scene with some of its bands, in this order. Their luminous weights sum to 1 again. A material that is clear in
/// some band stays clear in all: where its transmittance is 0, it becomes the smallest positive value.
Scene in_bands(Scene scene, const std::vector<Eigen::Index>& bands);

}  // namespace patchlight
