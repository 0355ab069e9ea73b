#include "patchlight/base/error.h"

#include "input/tables/read_tables.h"
#include "input/toml/toml_tables.h"
#include "light/photometry.h"
#include "light/spectra.h"
#include "scene/photometric_web.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace patchlight {
namespace {

using std::numbers::pi;

enum class LuminaireKind { point, spot, ies, sphere };

// The relative color of a light with given lumens.
Spectrum colour_of(const TomlValue& table) {
  const TomlValue* const value = find(table, "color");
  if (value == nullptr) return Spectrum::Ones(1);
  const Spectrum colour = spectrum(*value);
  if (!(luminance(colour) > 0)) refuse(*value, "a color that is not black");
  return colour;
}

// Watts between 380 and 780 nm that give the lumens of a light with this spectrum.
Spectrum watts_by_wavelength(const TomlValue& table, const TomlFrame& frame) {
  const double watts = number(*find(table, "watts"), "one number of watts beside a spectrum");
  const Cells light = in_cells(*light_spectrum(*find(table, "spectrum"), frame), Beyond::zero);
  return Spectrum::Constant(1, watts * luminance_of_cells(light) / light.sum() / luminous_efficacy);
}

// Flux per band in W: the given watts, or the given lumens at 179 lm/W.
Spectrum flux_of(const TomlValue& table, const TomlFrame& frame) {
  const std::string key = one_of(table, {"lumens", "watts"});
  if (key == "watts") {
    if (const TomlValue* const colour = find(table, "color")) refuse(*colour, "no color beside watts: give [R, G, B]");
    const Spectrum watts = spectrum(*find(table, key));
    return find(table, "spectrum") ? watts_by_wavelength(table, frame) : watts;
  }
  const Spectrum colour = colour_of(table);
  return not_negative(*find(table, key)) / luminance(colour) * colour;
}

double half_angle(const TomlValue& table, const std::string& key) {
  const std::string expected = "an angle above 0 and up to 180 degrees, from side to side";
  const TomlValue& value = required(table, key, expected);
  if (!(number(value, expected) > 0 && value.number <= 180)) refuse(value, expected);
  return 0.5 * value.number;
}

SpotLight spot_of(const TomlValue& table, const TomlFrame& frame) {
  SpotLight spot{.intensity = {},
                 .beam_half_angle = half_angle(table, "beam_angle"),
                 .field_half_angle = half_angle(table, "field_angle")};
  if (spot.beam_half_angle >= spot.field_half_angle) {
    refuse(*find(table, "field_angle"), "an angle above the beam_angle: there a tenth of the intensity is left");
  }
  spot.intensity = flux_of(table, frame) / spot_solid_angle(spot);
  return spot;
}

SphericalLamp sphere_of(const TomlValue& table, const TomlFrame& frame) {
  const double radius = frame.metres_per_unit * positive(required(table, "radius", "the radius of the sphere"));
  return {radius, flux_of(table, frame) / (4 * pi * radius * radius)};
}

// The photometric web of the file, scaled to the given lumens, if any.
WebLight web_of(const TomlValue& table, const TomlFrame& frame) {
  const auto web =
      std::make_shared<const PhotometricWeb>(read_ies(named_file(required(table, "file", "an IES file"), frame)));
  const Spectrum colour = colour_of(table);
  const Spectrum watts_per_lumen = colour / luminance(colour);
  const TomlValue* const lumens = find(table, "lumens");
  if (lumens == nullptr) return {web, watts_per_lumen};
  const double flux = luminous_flux(*web);
  if (!(flux > 0)) throw InputError(lumens->where, "luminaire.lumens: the photometric file gives no light to scale");
  return {web, not_negative(*lumens) / flux * watts_per_lumen};
}

void require_keys_of(const TomlValue& table, LuminaireKind kind) {
  const std::vector<std::string> common = {"name", "kind", "position", "positions", "lumens", "color", "spectrum"};
  const std::vector<std::vector<std::string>> own = {
      {"watts"}, {"watts", "aim", "beam_angle", "field_angle"}, {"aim", "zero_plane", "file"}, {"watts", "radius"}};
  std::vector<std::string> allowed = common;
  const std::vector<std::string>& more = own[static_cast<std::size_t>(kind)];
  allowed.insert(allowed.end(), more.begin(), more.end());
  allow_keys(table, allowed);
}

std::vector<Point> positions_of(const TomlValue& table, const TomlFrame& frame) {
  const std::string key = one_of(table, {"position", "positions"});
  const TomlValue& value = *find(table, key);
  if (key == "position") return {frame.metres_per_unit * vector(value)};
  if (value.kind != TomlValue::Kind::list || value.items.empty()) refuse(value, "a list of points [x, y, z]");
  std::vector<Point> positions;
  for (const TomlValue& item : value.items) positions.emplace_back(frame.metres_per_unit * vector(item));
  return positions;
}

LuminaireEntry entry_of(const TomlValue& table, const TomlFrame& frame) {
  const TomlValue& named = required(table, "kind", "one of 'point', 'spot', 'ies', 'sphere'");
  const LuminaireKind kind = choice<LuminaireKind>(named, {{"point", LuminaireKind::point},
                                                           {"spot", LuminaireKind::spot},
                                                           {"ies", LuminaireKind::ies},
                                                           {"sphere", LuminaireKind::sphere}});
  require_keys_of(table, kind);
  LuminaireEntry entry;
  if (const TomlValue* const given = find(table, "spectrum")) {
    if (find(table, "color")) one_of(table, {"color", "spectrum"});
    entry.luminaire.spectrum = light_spectrum(*given, frame);
  }
  entry.where = table.where;
  entry.luminaire.place = table.where;
  if (kind == LuminaireKind::point) entry.luminaire.light = PointLight{flux_of(table, frame) / (4 * pi)};
  if (kind == LuminaireKind::spot) entry.luminaire.light = spot_of(table, frame);
  if (kind == LuminaireKind::ies) entry.luminaire.light = web_of(table, frame);
  if (kind == LuminaireKind::sphere) entry.luminaire.light = sphere_of(table, frame);
  if (const TomlValue* const aim = find(table, "aim")) entry.aim = direction(*aim);
  if (const TomlValue* const zero = find(table, "zero_plane")) entry.zero_plane = direction(*zero);
  return entry;
}

int whole(const TomlValue& value, int low, int high) {
  const std::string expected = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (within(value, low, high, expected) != std::floor(value.number)) refuse(value, expected);
  return static_cast<int>(value.number);
}

// An irradiance in W/m^2 per band, or in lx.
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

}  // namespace

std::vector<LuminaireEntry> luminaires_of(const TomlValue& root, const TomlFrame& frame) {
  std::vector<LuminaireEntry> all;
  std::size_t number = 0;
  for (const TomlValue& table : tables(find(root, "luminaire"))) {
    ++number;
    LuminaireEntry entry = entry_of(table, frame);
    const TomlValue* const name = find(table, "name");
    entry.luminaire.name = name ? text(*name) : "luminaire " + std::to_string(number);
    for (const Point& position : positions_of(table, frame)) {
      entry.luminaire.position = position;
      all.push_back(entry);
    }
  }
  return all;
}

bool in_lumens(const TomlValue& root) {
  const std::vector<TomlValue> all = tables(find(root, "luminaire"));
  return std::any_of(all.begin(), all.end(), [](const TomlValue& t) { return find(t, "lumens") || find(t, "file"); });
}

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
  if (ground) {
    allow_keys(*ground, {"reflectance"});
    lights.ground_reflectance = within(required(*ground, "reflectance", "0 to 1"), 0, 1, "0 to 1");
  }
  // Measured irradiances are converted to visible light with their luminous efficacy.
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
