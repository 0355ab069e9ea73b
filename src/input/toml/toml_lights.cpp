#include "input/toml/toml_lights.h"

#include "patchlight/base/error.h"

#include "input/toml/toml_spectrum.h"
#include "light/photometry.h"

#include <cmath>
#include <utility>

namespace patchlight {
namespace {

double within(const TomlValue& value, double low, double high, const std::string& expected) {
  if (!(number(value, expected) >= low && value.number <= high)) refuse(value, expected);
  return value.number;
}

int whole(const TomlValue& value, int low, int high) {
  const std::string expected = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (within(value, low, high, expected) != std::floor(value.number)) refuse(value, expected);
  return static_cast<int>(value.number);
}

// A value in W/m^2 per band, or in lx.
Spectrum irradiance_of(const TomlValue& table) {
  const std::string key = one_of(table, {"irradiance", "illuminance"});
  if (key == "irradiance") return spectrum(*find(table, key));
  return Spectrum::Constant(1, not_negative(*find(table, key)) / luminous_efficacy);
}

Place site_of(const TomlValue& root, const TomlValue& needed_by) {
  const TomlValue* const site = find(root, "site");
  if (site == nullptr)
    throw InputError(needed_by.where, "sun.time needs a place: a table [site] with latitude and longitude");
  allow_keys(*site, {"latitude", "longitude"});
  const TomlValue& latitude = required(*site, "latitude", "degrees, north positive");
  const TomlValue& longitude = required(*site, "longitude", "degrees, east positive");
  return {within(latitude, -90, 90, "-90 to 90 degrees, north positive"),
          within(longitude, -180, 180, "-180 to 180 degrees, east positive")};
}

Instant instant_of(const TomlValue& value) {
  const std::string expected =
      "a date and time with its offset, e.g. 2024-06-21T12:00:00Z or 2024-06-21T13:00:00+01:00";
  if (value.kind != TomlValue::Kind::time || !value.time.minutes_east || value.time.year == 0) refuse(value, expected);
  const TomlTime& time = value.time;
  return {time.year, time.month, time.day, time.hour + (time.minute - *time.minutes_east) / 60.0 + time.second / 3600};
}

SunEntry sun_of(const TomlValue& root, const TomlValue& table, bool only_its_place) {
  allow_keys(table, {"direction", "time", "irradiance", "illuminance", "color_temperature"});
  SunEntry sun;
  sun.spectrum = daylight_of_temperature(table);
  if (one_of(table, {"direction", "time"}) == "direction") {
    sun.direction = direction(*find(table, "direction"));
  } else {
    sun.place = site_of(root, *find(table, "time"));
    sun.instant = instant_of(*find(table, "time"));
  }
  const bool has_strength = find(table, "irradiance") || find(table, "illuminance");
  if (has_strength || !only_its_place) sun.normal_irradiance = irradiance_of(table);
  return sun;
}

SkyEntry perez_of(const TomlValue& table, const TomlValue* sun) {
  allow_keys(table, {"kind", "direct_normal", "diffuse_horizontal", "color_temperature"});
  if (sun == nullptr)
    throw InputError(table.where, "a Perez sky needs the sun's place: a table [sun] with direction or time");
  for (const char* const key : {"irradiance", "illuminance"}) {
    if (const TomlValue* const strength = find(*sun, key)) {
      throw InputError(strength->where, strength->name + " is known from sky.direct_normal\nhint: leave it out");
    }
  }
  SolarIrradiance measured;
  measured.direct_normal = not_negative(required(table, "direct_normal", "W/m^2, as measured"));
  measured.diffuse_horizontal = not_negative(required(table, "diffuse_horizontal", "W/m^2, as measured"));
  return {SkyKind::perez, {}, measured, daylight_of_temperature(table)};
}

SkyEntry sky_of(const TomlValue& table, const TomlValue* sun) {
  const TomlValue& named = required(table, "kind", "one of 'uniform', 'overcast', 'clear', 'perez'");
  const SkyKind kind = choice<SkyKind>(named, {{"uniform", SkyKind::uniform},
                                               {"overcast", SkyKind::cie_overcast},
                                               {"clear", SkyKind::cie_clear},
                                               {"perez", SkyKind::perez}});
  if (kind == SkyKind::perez) return perez_of(table, sun);
  allow_keys(table, {"kind", "irradiance", "illuminance", "color_temperature"});
  if (kind == SkyKind::cie_clear && sun == nullptr) {
    throw InputError(named.where, "a clear sky needs the sun's place: a table [sun] with direction or time");
  }
  return {kind, irradiance_of(table), {}, daylight_of_temperature(table)};
}

WeatherHour weather_of(const TomlValue& table, const TomlFrame& frame) {
  allow_keys(table, {"file", "month", "day", "hour"});
  const std::filesystem::path file = named_file(required(table, "file", "the name of an EPW file"), frame);
  const int month = whole(required(table, "month", "1 to 12"), 1, 12);
  const int day = whole(required(table, "day", "1 to 31"), 1, 31);
  const int hour = whole(required(table, "hour", "the hour at which it begins, 0 to 23"), 0, 23);
  return read_epw(file, month, day, hour);
}

double ground_of(const TomlValue& table) {
  allow_keys(table, {"reflectance"});
  return within(required(table, "reflectance", "0 to 1"), 0, 1, "0 to 1");
}

}  // namespace

LightEntries lights_of(const TomlValue& root, const TomlFrame& frame) {
  LightEntries lights;
  lights.where = root.where;
  lights.luminaires = luminaires_of(root, frame);
  lights.photometric = in_lumens(root);
  if (const TomlValue* const north = find(root, "north")) {
    lights.north = direction(*north);
    lights.where = north->where;
  }
  const TomlValue* const sun = find(root, "sun");
  const TomlValue* const sky = find(root, "sky");
  const TomlValue* const weather = find(root, "weather");
  const TomlValue* const ground = find(root, "ground");
  for (const TomlValue* const other : {sun, sky}) {
    if (weather && other)
      throw InputError(other->where, "sun and sky are known from [weather]\nhint: leave one of them out");
    if (other) lights.where = other->where;
    if (other && find(*other, "illuminance")) lights.photometric = true;
  }
  if (ground && !sky && !weather) throw InputError(ground->where, "ground is seen with a sky only; expected [sky] too");
  if (sky) lights.sky = sky_of(*sky, sun);
  if (sun) lights.sun = sun_of(root, *sun, sky && (lights.sky->measured || lights.sky->kind == SkyKind::cie_clear));
  if (lights.sky && lights.sky->measured && lights.sun && !lights.sun->direction) {
    lights.sky->measured->day_of_year = day_of_year(lights.sun->instant);
  }
  if (weather) lights.weather = weather_of(*weather, frame);
  if (ground) lights.ground_reflectance = ground_of(*ground);
  // Measured irradiances become visible light by their luminous efficacy.
  if (weather || (lights.sky && lights.sky->measured)) lights.photometric = true;
  return lights;
}

std::vector<std::filesystem::path> light_files(const TomlValue& root, const TomlFrame& frame) {
  std::vector<std::filesystem::path> files;
  for (const TomlValue& table : tables(find(root, "luminaire"))) {
    if (const TomlValue* const file = find(table, "file")) files.push_back(named_file(*file, frame));
  }
  if (const TomlValue* const weather = find(root, "weather"))
    files.push_back(named_file(*find(*weather, "file"), frame));
  return files;
}

}  // namespace patchlight
