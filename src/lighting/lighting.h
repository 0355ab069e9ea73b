#pragma once

#include "patchlight/scene/scene.h"

#include "lighting/light_paths.h"
#include "lighting/sky.h"
#include "lighting/sky_openings.h"

#include <array>
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

/// Light that arrives at a point from one direction.
struct Arrival {
  Point from;                        ///< a point of the source, or one beyond the scene
  double irradiance = 0;             ///< of the point if nothing is in the way, for a color of 1; 0: none
  const Spectrum* colour = nullptr;  ///< of the light; lives as long as the lighting
};

/// A point that receives light.
struct SurfacePoint {
  Point point;
  Vector normal;  ///< unit, of the receiving side
  PolygonIndex polygon = no_polygon;
};

/// From a luminaire. For a sphere, returns one sample of its irradiance, at the direction for (u, v) of the unit
/// square. Directions are uniform in the solid angle of the sphere (Shirley, Wang and Zimmerman 1996, section 3.2). The
/// mean over the square is the irradiance.
Arrival from_luminaire(const Luminaire& luminaire, const Vector& up, const SurfacePoint& at, const Eigen::Vector2d& uv);

/// From the sun, which must be there.
Arrival from_sun(const Lighting& lighting, const SurfacePoint& at);

/// A triangle, with its last corner repeated, or a convex quadrilateral that emits from its front.
struct LampFace {
  std::array<Point, 4> corners;
  Vector normal;  ///< unit
  double area = 0;
  PolygonIndex polygon = no_polygon;
  Spectrum exitance;  ///< W/m^2
};

/// The triangles and convex quadrilaterals of a side of a polygon that emits.
std::vector<LampFace> lamp_faces(const Scene& scene, PolygonIndex polygon, Side side);

}  // namespace patchlight
