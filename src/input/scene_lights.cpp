#include "input/scene_lights.h"

#include "patchlight/base/error.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "light/photometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace patchlight {
namespace {

// One value applies to all bands.
Spectrum spread(const Spectrum& spectrum, Eigen::Index bands) {
  return spectrum.size() == 1 ? Spectrum::Constant(bands, spectrum[0]) : spectrum;
}

// The component of a direction perpendicular to a unit vector, normalized; zero if parallel.
Vector across(const Vector& direction, const Vector& axis) {
  const Vector part = direction - direction.dot(axis) * axis;
  return part.norm() > tolerance_of_coordinates ? part.normalized() : Vector(Vector::Zero());
}

// Default: north of the model file, else y for vertical axis z, and -z for y.
Vector north_of(const Scene& scene, const LightEntries& lights) {
  const Vector usual = std::abs(scene.up.y()) > 0.5 ? Vector(0, 0, -1) : Vector(0, 1, 0);
  const Vector given = lights.north.value_or(scene.north_stated ? scene.north : usual);
  Vector north = across(given, scene.up);
  if (north.isZero()) throw InputError(lights.where, "north points up or down; expected a level direction [x, y, z]");
  return north;
}

struct Spread {
  Eigen::Index bands;
  void operator()(PointLight& light) const { light.intensity = spread(light.intensity, bands); }
  void operator()(SpotLight& light) const { light.intensity = spread(light.intensity, bands); }
  void operator()(WebLight& light) const { light.watts_per_lumen = spread(light.watts_per_lumen, bands); }
  void operator()(SphericalLamp& light) const { light.exitance = spread(light.exitance, bands); }
};

Luminaire luminaire_of(const LuminaireEntry& entry, const Scene& scene, Eigen::Index bands) {
  Luminaire luminaire = entry.luminaire;
  luminaire.aim = entry.aim.value_or(-scene.up);
  // By default the horizontal angle 0 points east, or north for a luminaire that is aimed east or west.
  const Vector east = scene.north.cross(scene.up);
  Vector zero = across(entry.zero_plane.value_or(east), luminaire.aim);
  if (zero.isZero() && entry.zero_plane) {
    throw InputError(entry.where, "luminaire.zero_plane points along the aim; expected a direction across it");
  }
  luminaire.zero_plane = zero.isZero() ? across(scene.north, luminaire.aim) : zero;
  std::visit(Spread{bands}, luminaire.light);
  return luminaire;
}

Vector direction_of(const SunEntry& sun, const Scene& scene) {
  if (sun.direction) return *sun.direction;
  return direction_to(sun.position.value_or(solar_position(sun.place, sun.instant)), scene.up, scene.north);
}

Daylight daylight_of(const LightEntries& lights, const Scene& scene, Eigen::Index bands) {
  if (lights.weather) return daylight_of(*lights.weather, scene.up, scene.north, bands);
  Daylight daylight;
  const Vector direction = lights.sun ? direction_of(*lights.sun, scene) : scene.sun ? scene.sun->direction : scene.up;
  if (lights.sky && lights.sky->measured && lights.sky->measured->direct_normal > 0 && direction.dot(scene.up) < 0) {
    const double below = std::asin(std::min(1.0, -direction.dot(scene.up))) * 180 / std::numbers::pi;
    throw InputError(lights.where, "sky.direct_normal: found " + rounded(lights.sky->measured->direct_normal) +
                                       " W/m^2 while the sun is " + rounded(below) +
                                       " degrees below the horizon; expected 0 then, or another time or place");
  }
  if (lights.sky && lights.sky->measured) return measured_daylight(*lights.sky->measured, direction, scene.up, bands);
  if (lights.sun && lights.sun->normal_irradiance.size() > 0) {
    daylight.sun = Sun{direction, spread(lights.sun->normal_irradiance, bands)};
  }
  if (!lights.sky) return daylight;
  const bool needs_sun = lights.sky->kind == SkyKind::cie_clear;
  if (needs_sun && direction.dot(scene.up) < 0) {
    throw InputError(lights.where, "sky.kind: found 'clear' while the sun is below the horizon; expected it above");
  }
  daylight.sky = Sky{.kind = lights.sky->kind,
                     .horizontal_irradiance = spread(lights.sky->horizontal_irradiance, bands),
                     .sun_direction = direction};
  return daylight;
}

// Adds the spectra of the stated color temperatures.
Daylight with_spectra(Daylight daylight, const LightEntries& lights) {
  if (daylight.sun && lights.sun) daylight.sun->spectrum = lights.sun->spectrum;
  if (daylight.sky && lights.sky) daylight.sky->spectrum = lights.sky->spectrum;
  return daylight;
}

// The row of a weather file, and the light that follows from it.
Diagnostic note_on(const WeatherHour& weather, const Daylight& daylight, const Bands& bands) {
  const SolarPosition sun = solar_position(weather.place, weather.middle);
  const auto lux = [&](const Spectrum& irradiance) { return " (" + rounded(luminance(irradiance, bands)) + " lx)"; };
  std::string text = weather.where + ": month " + std::to_string(weather.middle.month) + ", day " +
                     std::to_string(weather.middle.day) + ", " + std::to_string(weather.begin) + " to " +
                     std::to_string(weather.begin + 1) + " h standard time: sun at altitude " + rounded(sun.altitude) +
                     ", azimuth " + rounded(sun.azimuth) + " degrees; direct normal " +
                     rounded(weather.solar.direct_normal) + " W/m^2" +
                     (daylight.sun ? lux(daylight.sun->normal_irradiance) : " (none is simulated)") +
                     ", diffuse horizontal " + rounded(weather.solar.diffuse_horizontal) + " W/m^2" +
                     (daylight.sky ? lux(daylight.sky->horizontal_irradiance) : "");
  if (!daylight.sky) return {DiagnosticCode::simplified_light, text + "; no sky"};
  const bool is_perez = daylight.sky->kind == SkyKind::perez;
  text += is_perez ? "; Perez sky, clearness " + rounded(daylight.sky->clearness) + ", brightness " +
                         rounded(daylight.sky->brightness)
                   : std::string("; uniform sky, as the sun is below the horizon");
  return {DiagnosticCode::simplified_light, text};
}

}  // namespace

Scene with_lights(Scene scene, const LightEntries& lights) {
  const Eigen::Index bands = number_of_bands(scene);
  scene.photometric = scene.photometric || lights.photometric;
  scene.north = north_of(scene, lights);
  for (const LuminaireEntry& entry : lights.luminaires) scene.luminaires.push_back(luminaire_of(entry, scene, bands));
  if (!lights.sun && !lights.sky && !lights.weather) return scene;
  Daylight daylight = with_spectra(daylight_of(lights, scene, bands), lights);
  if ((scene.sun && daylight.sun) || (scene.sky && daylight.sky))
    throw InputError(lights.where, "a file read before has sun or sky; expected each once");
  if (lights.weather) scene.diagnostics.push_back(note_on(*lights.weather, daylight, bands_of(scene)));
  if (daylight.sun) scene.sun = daylight.sun;
  if (daylight.sky) scene.sky = above_ground({scene.sun, daylight.sky}, lights.ground_reflectance, scene.up, bands).sky;
  return scene;
}

}  // namespace patchlight
