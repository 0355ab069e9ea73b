#include "lighting/lighting.h"

#include "lighting/mirror_paths.h"
#include "lighting/shades.h"

namespace patchlight {
Lighting lighting_of(const Scene& scene, const Tracing& tracing) {
  Lighting lighting{.luminaires = scene.luminaires,
                    .sun = {},
                    .sky = {},
                    .openings = {},
                    .up = scene.up,
                    .bands = number_of_bands(scene),
                    .paths = LightPaths(scene, tracing),
                    .shades = {},
                    .mirrors = {}};
  if (scene.sun && scene.sun->direction.dot(scene.up) > 0) lighting.sun = scene.sun;
  if (lighting.sun || !scene.luminaires.empty())
    lighting.shades = std::make_shared<const Shades>(scene, tracing.coverings(), lighting.paths.optics());
  if (scene.sky) {
    lighting.sky = sky_model(*scene.sky, scene.up);
    lighting.openings = sky_openings(scene, lighting.paths);
  }
  if (tracing.reflections() == Reflections::followed && tracing.has_specular_surfaces())
    lighting.mirrors = std::make_shared<const Mirrors>(scene, tracing, lighting);
  return lighting;
}

}  // namespace patchlight
