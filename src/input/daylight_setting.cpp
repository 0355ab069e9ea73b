#include "input/daylight_setting.h"

#include "patchlight/base/error.h"

#include "input/text.h"
#include "light/photometry.h"

namespace patchlight {
namespace {

// What is seen of the ground of most places.
constexpr double usual_ground = 0.2;

Spectrum irradiance_for(double illuminance) { return Spectrum::Constant(1, illuminance / luminous_efficacy); }

// What cannot be together, or is missing.
void require_consistent(const DaylightSetting& setting) {
  if (setting.weather && (setting.sky || setting.sun))
    throw InputError("read.daylight.weather", std::string("cannot be used with ") +
                                                  (setting.sky ? "read.daylight.sky" : "read.daylight.sun") +
                                                  ": a weather file has both sun and sky");
  if (setting.ground_reflectance && !setting.sky && !setting.weather)
    throw InputError("read.daylight.ground",
                     "needs a sky, which lights the ground\nhint: read.daylight.sky=overcast:10000lx");
  const bool needs_sun = setting.sky == SkyKind::cie_clear || setting.sky == SkyKind::perez;
  if (needs_sun && !setting.sun)
    throw InputError("read.daylight.sky",
                     "this sky needs the position of the sun\n"
                     "hint: read.daylight.sun=40,180 or read.daylight.sun=2024-06-21T12:00:00Z@52.5,13.4");
  const bool shapes_only = setting.sun && !(setting.sun_illuminance > 0) && !needs_sun;
  if (shapes_only)
    throw InputError("read.daylight.sun", "direct normal illuminance missing\nhint: read.daylight.sun=40,180:80000lx");
  if (setting.measured && setting.sun_illuminance > 0)
    throw InputError("read.daylight.sun",
                     "this sky already states the illuminance of the sun\nhint: leave it out of read.daylight.sun");
}

SunEntry sun_entry(const DaylightSetting& setting) {
  SunEntry sun;
  sun.position = SolarPosition{setting.sun->altitude, setting.sun->azimuth};
  if (setting.sun_illuminance > 0) sun.normal_irradiance = irradiance_for(setting.sun_illuminance);
  return sun;
}

SkyEntry sky_entry(const DaylightSetting& setting) {
  if (setting.sky != SkyKind::perez) return {*setting.sky, irradiance_for(setting.sky_illuminance), {}, {}};
  SolarIrradiance measured = setting.measured.value_or(SolarIrradiance{});
  measured.day_of_year = setting.sun->day_of_year;
  return {SkyKind::perez, {}, measured, {}};
}

}  // namespace

bool asks_for_daylight(const DaylightSetting& setting) {
  return setting.sky || setting.sun || setting.weather || setting.ground_reflectance;
}

LightEntries lights_of(const DaylightSetting& setting, const std::filesystem::path& confine) {
  require_consistent(setting);
  LightEntries lights;
  lights.photometric = true;
  lights.where = setting.sky ? "read.daylight.sky" : setting.sun ? "read.daylight.sun" : "read.daylight.weather";
  if (setting.weather) {
    require_within(confine, setting.weather->file, "read.daylight.weather");
    lights.weather =
        read_epw(setting.weather->file, setting.weather->month, setting.weather->day, setting.weather->hour);
  }
  if (setting.sun) lights.sun = sun_entry(setting);
  if (setting.sky) lights.sky = sky_entry(setting);
  if (setting.sky || setting.weather) lights.ground_reflectance = setting.ground_reflectance.value_or(usual_ground);
  return lights;
}

}  // namespace patchlight
