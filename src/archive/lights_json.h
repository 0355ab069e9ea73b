#pragma once

#include "patchlight/scene/scene.h"

#include "archive/json_values.h"

namespace patchlight {

/// The luminaires, sun and sky of a scene, and which way is north.
Json lights_part(const Scene& scene);

/// The scene with the lights of such a part. \throws what nlohmann::json throws, or std::out_of_range, where it is
/// damaged.
Scene with_lights_of(Scene scene, const Json& json);

/// Where irradiance and pictures of a scene are wanted.
Json views_part(const Scene& scene);

/// The scene with the sensors and cameras of such a part. \throws as with_lights_of().
Scene with_views_of(Scene scene, const Json& json);

}  // namespace patchlight
