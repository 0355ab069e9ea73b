#pragma once

#include "patchlight/scene/scene.h"

#include "lighting/light_paths.h"
#include "lighting/sky.h"
#include "lighting/sky_openings.h"

#include <memory>
#include <optional>
#include <vector>

namespace patchlight {

class Shades;
struct Mirrors;

/// The light sources of a scene other than patches, prepared for direct_irradiance(). Immutable and thread-safe.
struct Lighting {
  std::vector<Luminaire> luminaires;
  std::optional<Sun> sun;  ///< nothing while it is below the horizon
  std::optional<SkyModel> sky;
  std::vector<Opening> openings;  ///< none without a sky
  Vector up;
  Eigen::Index bands = 0;
  LightPaths paths;
  std::shared_ptr<const Shades> shades;    ///< of sun and luminaires; null without them
  std::shared_ptr<const Mirrors> mirrors;  ///< null where there are none, or reflections are not followed
};

/// The scene must have passed check(). Places over which another polygon lies get no light.
Lighting lighting_of(const Scene& scene, const Tracing& tracing);

/// A point that receives light.
struct SurfacePoint {
  Point point;
  Vector normal;  ///< unit, of the receiving side
  PolygonIndex polygon = no_polygon;
};

}  // namespace patchlight
