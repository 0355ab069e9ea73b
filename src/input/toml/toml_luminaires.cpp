#include "patchlight/base/error.h"

#include "input/tables/read_ies.h"
#include "input/toml/toml_lights.h"
#include "input/toml/toml_spectrum.h"
#include "light/photometry.h"
#include "light/spectra.h"
#include "scene/photometric_web.h"

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

using std::numbers::pi;

enum class LuminaireKind { point, spot, ies, sphere };

// The colour of a light whose lumens are given: any multiple of it.
Spectrum colour_of(const TomlValue& table) {
  const TomlValue* const value = find(table, "color");
  if (value == nullptr) return Spectrum::Ones(1);
  const Spectrum colour = spectrum(*value);
  if (!(luminance(colour) > 0)) refuse(*value, "a color that is not black");
  return colour;
}

// The watts between 380 and 780 nm, such that the lumens of a light with this spectrum are right.
Spectrum watts_by_wavelength(const TomlValue& table, const TomlFrame& frame) {
  const double watts = number(*find(table, "watts"), "one number of watts beside a spectrum");
  const Cells light = in_cells(*light_spectrum(*find(table, "spectrum"), frame), Beyond::zero);
  return Spectrum::Constant(1, watts * luminance_of_cells(light) / light.sum() / luminous_efficacy);
}

// Flux per band in W: the watts as given, or with 179 lm/W as many lumens as given.
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

// As the file says, or dimmed or brightened to the lumens given.
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

}  // namespace patchlight
