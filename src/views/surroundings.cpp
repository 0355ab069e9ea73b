#include "views/surroundings.h"

#include "lighting/sky.h"
#include "pipeline/world.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace patchlight {

std::function<Spectrum(const Vector&)> surroundings_of(const Scene& scene) {
  if (!scene.sky) return {};
  constexpr double sun_radius = 0.2665 * std::numbers::pi / 180;  // as seen from the earth
  const SkyModel sky = sky_model(*scene.sky, scene.up);
  return [sky, sun = scene.sun](const Vector& direction) -> Spectrum {
    Spectrum seen = radiance(sky, direction);
    // L = E / solid angle, 2 pi (1 - cos)
    if (sun && direction.dot(sun->direction) > std::cos(sun_radius) && direction.dot(sky.up) > 0)
      seen += sun->normal_irradiance / (2 * std::numbers::pi * (1 - std::cos(sun_radius)));
    return seen;
  };
}

std::function<Spectrum(const Vector&)> sky_of(const Simulation& simulation) {
  Scene seen = simulation.world->sensor_scene();
  seen.sun.reset();
  return surroundings_of(seen);
}

}  // namespace patchlight
