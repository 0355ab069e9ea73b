#include "scene/limits.h"

#include "patchlight/base/error.h"

#include "scene/extent.h"

#include <sstream>
#include <variant>

namespace patchlight {
namespace {

constexpr double brightest = 1e25;

// Squares of weaker light would be below the smallest double.
constexpr double weakest = 1e-150;

void require_strength(const Spectrum& strength, const std::string& where, const std::string& what) {
  for (const double value : strength) {
    if (value == 0 || (value >= weakest && value <= brightest)) continue;
    std::ostringstream text;
    text << what << " is " << value << "; expected 0 or a number from " << weakest << " to " << brightest
         << " in every band";
    throw InputError(where, text.str());
  }
}

void check_luminaire(const Luminaire& luminaire, const Reach& reach) {
  require_in_reach(reach, luminaire.position, luminaire.place, "the position of luminaire '" + luminaire.name + "'");
  const std::string what = " of luminaire '" + luminaire.name + "'";
  if (const auto* const point = std::get_if<PointLight>(&luminaire.light)) {
    require_strength(point->intensity, luminaire.place, "the intensity in W/sr" + what);
  } else if (const auto* const spot = std::get_if<SpotLight>(&luminaire.light)) {
    require_strength(spot->intensity, luminaire.place, "the intensity in W/sr" + what);
  } else if (const auto* const web = std::get_if<WebLight>(&luminaire.light)) {
    require_strength(web->watts_per_lumen, luminaire.place, "the scale in W/lm" + what);
  } else if (const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light)) {
    require_strength(sphere->exitance, luminaire.place, "the exitance in W/m^2" + what);
    const Point rim = luminaire.position + Vector(sphere->radius, 0, 0);
    require_in_reach(reach, rim, luminaire.place, "the rim" + what);
  }
}

void check_daylight(const Scene& scene) {
  if (scene.sun) require_strength(scene.sun->normal_irradiance, scene.file, "the sun's irradiance in W/m^2");
  if (!scene.sky) return;
  require_strength(scene.sky->horizontal_irradiance, scene.file, "the sky's irradiance in W/m^2");
  require_strength(scene.sky->zenith_radiance, scene.file, "the sky's radiance in W/(m^2 sr)");
  require_strength(scene.sky->ground_radiance, scene.file, "the ground's radiance in W/(m^2 sr)");
}

}  // namespace

Reach reach_of(const Scene& scene) {
  const Box box = main_bounds(scene);
  return {box.center(), most_extents * box.diagonal().norm()};
}

void require_in_reach(const Reach& reach, const Point& position, const std::string& where, const std::string& what) {
  const Vector offset = position - reach.centre;
  if (offset.stableNorm() <= reach.distance) return;
  std::ostringstream text;
  text << what << " is " << offset.stableNorm() << " m from the middle of the scene; expected at most "
       << reach.distance << " m, 1e12 times its size. Are the units the same?";
  throw InputError(where, text.str());
}

void check_limits(const Scene& scene) {
  for (const Material& material : scene.materials) {
    require_strength(material.exitance, scene.file, "the exitance in W/m^2 of material '" + material.name + "'");
  }
  const Reach reach = reach_of(scene);
  for (const Luminaire& luminaire : scene.luminaires) check_luminaire(luminaire, reach);
  check_daylight(scene);
  for (const SensorGroup& group : scene.sensors) {
    for (std::size_t k = 0; k < group.sensors.size(); ++k) {
      require_in_reach(reach, group.sensors[k].point, scene.file, place_of(group, k));
    }
  }
  for (const Camera& camera : scene.cameras) {
    require_in_reach(reach, camera.eye, scene.file, "the eye of camera '" + camera.name + "'");
    require_in_reach(reach, camera.target, scene.file, "the target of camera '" + camera.name + "'");
  }
}

}  // namespace patchlight
