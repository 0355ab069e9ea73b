#include "input/material_settings.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "input/materials.h"
#include "input/text.h"
#include "light/photometry.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <set>

namespace patchlight {
namespace {

// A scene in which these polygons do not share these materials with other polygons.
struct OwnMaterials {
  Scene scene;
  std::vector<std::size_t> materials;  // copies that replace the given materials
};

std::string file_of(const Scene& scene, const Polygon& polygon) {
  return polygon.file < scene.files.size() ? scene.files[polygon.file] : scene.file;
}

// Throws: the pattern matches none of the groups and names; `kinds` is "object, group or file".
[[noreturn]] void refuse_pattern(const Scene& scene, std::set<std::string> names, const std::string& kinds,
                                 const std::string& pattern, const std::string& where) {
  for (std::uint32_t group = 0; group < scene.groups.size(); ++group) names.insert(group_name(scene, group));
  const std::vector<std::string> allowed(names.begin(), names.end());
  const std::string hint = suggestion(pattern, allowed);
  throw InputError(where, "no face is of an " + kinds + " '" + pattern + "'" +
                              (hint.empty() ? "; patchlight check --all lists the names" : hint));
}

std::string name_of_file(const std::string& file) { return std::filesystem::path(file).filename().string(); }

// True for each polygon whose object, group or file has this name or matches the pattern with * and ?. Patterns match
// the last part of a file's path; a plain name may be the whole path. Throws InputError at `where` when nothing
// matches.
std::vector<bool> faces_of(const Scene& scene, const std::string& pattern, const std::string& where) {
  std::vector<bool> groups;
  for (std::uint32_t group = 0; group < scene.groups.size(); ++group)
    groups.push_back(matches(group_name(scene, group), pattern));
  std::vector<bool> faces;
  for (const Polygon& polygon : scene.polygons) {
    const std::string file = file_of(scene, polygon);
    const bool by_group = polygon.group < groups.size() && groups[polygon.group];
    faces.push_back(by_group || file == pattern || matches(name_of_file(file), pattern));
  }
  if (std::find(faces.begin(), faces.end(), true) != faces.end()) return faces;
  std::set<std::string> names;
  for (const std::string& file : scene.files) names.insert(name_of_file(file));
  refuse_pattern(scene, std::move(names), "object, group or file", pattern, where);
}

// The materials of these polygons, in order.
std::vector<std::size_t> materials_of(const Scene& scene, const std::vector<bool>& polygons) {
  std::set<std::size_t> materials;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!polygons[p]) continue;
    materials.insert(scene.polygons[p].material);
    if (scene.polygons[p].back_material) materials.insert(*scene.polygons[p].back_material);
  }
  return {materials.begin(), materials.end()};
}

// Copies the materials that other polygons also use, named after `of`: "Concrete of IfcSlab*".
OwnMaterials with_own_materials(Scene scene, const std::vector<bool>& polygons, std::vector<std::size_t> materials,
                                const std::string& of) {
  std::vector<bool> others = polygons;
  others.flip();
  const std::vector<std::size_t> shared = materials_of(scene, others);
  for (std::size_t& material : materials) {
    if (!std::binary_search(shared.begin(), shared.end(), material)) continue;
    const auto copy = static_cast<MaterialIndex>(scene.materials.size());
    scene.materials.push_back(scene.materials[material]);
    scene.materials.back().name += " of " + of;
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      Polygon& polygon = scene.polygons[p];
      if (!polygons[p]) continue;
      if (polygon.material == material) polygon.material = copy;
      if (polygon.back_material == material) polygon.back_material = copy;
    }
    material = copy;
  }
  return {std::move(scene), std::move(materials)};
}

using Quantity = MaterialSetting::Quantity;

[[noreturn]] void refuse_setting(const std::string& text, const std::string& message) {
  throw InputError("read.settings", "found '" + text + "': " + message);
}

constexpr const char* settable =
    "reflectance, specular_reflectance, transmittance or diffuse_transmittance (0 to 1, or in %), exitance (W/m^2), "
    "radiance (W/(m^2 sr)) or index, as numbers without a unit";

// Advice for lights specified by flux: exitance is flux per area.
std::string advice_on_flux(const std::string& quantity) {
  constexpr std::array words{"flux", "luminous_flux", "lumens", "lumen", "lm", "watts", "watt", "W", "power"};
  if (std::find(words.begin(), words.end(), quantity) == words.end()) return {};
  const std::string efficacy = shortest(luminous_efficacy);
  return "\nhint: exitance = lumens / (" + efficacy +
         " x area in m^2), or watts / area"
         "\nhint: luminaires of a scene file take lumens or watts";
}

Quantity quantity_named(const std::string& name, const std::string& text) {
  for (const auto& [word, quantity] : named_quantities)
    if (name == word && quantity != Quantity::light_spectrum) return quantity;
  refuse_setting(text, "'" + name + "' cannot be set; expected " + settable + advice_on_flux(name));
}

// The expected form of a value.
const char* expected_value(Quantity quantity) {
  if (is_share(quantity)) return "a fraction from 0 to 1, or a percentage, e.g. 30%";
  if (quantity == Quantity::exitance) return "W/m^2 without the unit, e.g. 10";
  if (quantity == Quantity::radiance) return "W/(m^2 sr) without the unit, e.g. 10";
  return expected_index;
}

// A number, or a percentage: 0.3 for 30%.
std::optional<double> number_or_percent(const std::string& word, Quantity quantity) {
  if (!word.ends_with('%') || !is_share(quantity)) return finite_number(word);
  const std::optional<double> percent = finite_number(trimmed(std::string_view(word).substr(0, word.size() - 1)));
  return percent ? std::optional<double>(*percent / 100) : std::nullopt;
}

Spectrum comma_separated(const std::string& list, const std::string& text, Quantity quantity) {
  std::vector<double> values;
  for (const std::string_view part : between_commas(list)) {
    const std::string word(trimmed(part));
    const std::optional<double> value = number_or_percent(word, quantity);
    if (!value) refuse_setting(text, "'" + word + "' is not a finite number; expected " + expected_value(quantity));
    values.push_back(*value);
  }
  if (values.size() != 1 && values.size() != 3) {
    refuse_setting(text, std::to_string(values.size()) + " values; expected one for all bands, or three: R,G,B");
  }
  return Eigen::Map<const Spectrum>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// One value applies to all bands.
Spectrum spread(const MaterialSetting& setting, Eigen::Index bands) {
  if (setting.value.size() == 1) return Spectrum::Constant(bands, setting.value[0]);
  if (setting.value.size() == bands) return setting.value;
  throw InputError(setting.where, "found " + std::to_string(setting.value.size()) + " values for material '" +
                                      setting.material + "'; expected one, or one for each of " +
                                      std::to_string(bands) + " bands");
}

// The exitance of a setting. In bands of wavelengths the value is linear RGB and is converted like a color that was
// read. One number sets the luminance and keeps the spectrum of the lamp.
Spectrum set_light(const MaterialSetting& setting, const Material& material, const Bands& bands) {
  if (!are_of_wavelengths(bands)) return spread(setting, material.exitance.size());
  const bool is_one = setting.value.size() == 1;
  const Spectrum colour = is_one ? Spectrum::Constant(3, setting.value[0]) : setting.value;
  Spectrum light = light_in_bands(bands, colour, nullptr);
  const double found = luminance(material.exitance, bands);
  if (is_one && found > 0) return luminance(light, bands) / found * material.exitance;
  return light;
}

// The spectrum of a quantity by wavelength; null for quantities without a spectrum.
std::shared_ptr<const SampledSpectrum>* sampled_of(MaterialSpectra& spectra, Quantity quantity) {
  switch (quantity) {
    case Quantity::reflectance:
      return &spectra.reflectance;
    case Quantity::transmittance:
      return &spectra.transmittance;
    case Quantity::specular_reflectance:
      return &spectra.specular_reflectance;
    case Quantity::diffuse_transmittance:
      return &spectra.diffuse_transmittance;
    case Quantity::exitance:
    case Quantity::radiance:
    case Quantity::light_spectrum:
      return &spectra.light;
    case Quantity::index:
      return nullptr;
  }
  return nullptr;
}

// One number only scales a lamp. Every other value replaces the spectrum.
MaterialSpectra changed(MaterialSpectra spectra, const MaterialSetting& setting) {
  const bool is_of_lamp = setting.quantity == Quantity::exitance || setting.quantity == Quantity::radiance;
  const bool keeps_spread = is_of_lamp && setting.value.size() == 1;
  std::shared_ptr<const SampledSpectrum>* const sampled = sampled_of(spectra, setting.quantity);
  if (sampled && !keeps_spread) *sampled = setting.sampled;
  return spectra;
}

// Sets a value for each band. A setting that makes a pane removes the mirror of the file, and vice versa. The value 0
// removes the file's own pane or mirror.
Material with_quantity(Material material, Quantity quantity, const Spectrum& value) {
  const bool is_some = (value > 0).any();
  switch (quantity) {
    case Quantity::reflectance:
      material.reflectance = value;
      if (material.stated_pane) material.stated_pane->matt_reflectance = value;
      if (material.stated_mirror) material.stated_mirror->matt_reflectance = value;
      break;
    case Quantity::exitance:
    case Quantity::radiance:
      material.exitance = quantity == Quantity::radiance ? Spectrum(std::numbers::pi * value) : value;  // E = pi L
      if (material.stated_pane) material.stated_pane->matt_exitance = Spectrum();
      break;
    case Quantity::transmittance:
      material = is_some ? without_stated_mirror(std::move(material)) : without_stated_pane(std::move(material));
      material.stated_pane.reset();
      material.transmittance = value;
      break;
    case Quantity::index:
      material.index = value[0];
      break;
    case Quantity::specular_reflectance:
      material = is_some ? without_stated_pane(std::move(material)) : without_stated_mirror(std::move(material));
      material.stated_mirror.reset();
      material.specular_reflectance = value;
      break;
    case Quantity::diffuse_transmittance:
      material.diffuse_transmittance = value;
      break;
    case Quantity::light_spectrum:
      break;
  }
  return material;
}

// A reflectance replaces a texture: only opaque matt surfaces have textures.
Material changed(Material material, const MaterialSetting& setting, const Bands& bands) {
  material.spectra = changed(std::move(material.spectra), setting);
  if (setting.quantity == Quantity::light_spectrum) return material;
  const bool is_of_light_sent_on = setting.quantity != Quantity::exitance && setting.quantity != Quantity::radiance;
  const Spectrum value =
      is_of_light_sent_on ? spread(setting, material.reflectance.size()) : set_light(setting, material, bands);
  const bool is_some = (value > 0).any();
  if (is_of_light_sent_on && (is_some || setting.quantity == Quantity::reflectance)) material.texture.reset();
  return with_quantity(std::move(material), setting.quantity, value);
}

// The candidates that a setting matches. Patterns do not match second faces of panes, which readers make up.
std::vector<std::size_t> chosen(const std::vector<Material>& materials, const std::vector<std::size_t>& candidates,
                                const MaterialSetting& setting) {
  std::vector<std::size_t> by_pattern;
  std::vector<std::string> names;
  for (const std::size_t m : candidates) {
    if (materials[m].name == setting.material) return {m};
    if (materials[m].second_face) continue;
    if (matches(materials[m].name, setting.material)) by_pattern.push_back(m);
    names.push_back(materials[m].name);
  }
  if (!by_pattern.empty()) return by_pattern;
  const std::string hint = suggestion(setting.material, names);
  throw InputError(setting.where, std::string("no face ") + (setting.of.empty() ? "" : "of '" + setting.of + "' ") +
                                      "has a material '" + setting.material + "'" + hint +
                                      (hint.empty() ? "; expected one of " : " Expected one of ") + listed(names));
}

// The matching materials among all.
std::vector<std::size_t> chosen(const std::vector<Material>& materials, const MaterialSetting& setting) {
  std::vector<std::size_t> all(materials.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return chosen(materials, all, setting);
}

// \throws InputError when a setting gives an index to opaque materials only.
void require_transmittance(const std::vector<Material>& materials, const std::vector<std::size_t>& meant,
                           const MaterialSetting& setting) {
  if (setting.quantity != Quantity::index) return;
  for (const std::size_t m : meant) {
    if (materials[m].transmittance.size() > 0) return;
  }
  throw InputError(setting.where, "found the index of refraction " + shortest(setting.value[0]) + " for material '" +
                                      setting.material +
                                      "', which has no transmittance; the index needs one\nhint: add read.settings " +
                                      setting.material + ".transmittance=0.8, or leave out the index");
}

// Newell's formula: the scene is not repaired yet.
double area_of(const Scene& scene, PolygonIndex polygon) {
  const std::vector<Point> points = corner_points(scene, polygon);
  Vector twice = Vector::Zero();
  for (std::size_t k = 0; k < points.size(); ++k)
    twice += (points[k] - points[0]).cross(points[(k + 1) % points.size()] - points[0]);
  return twice.norm() / 2;
}

// Groups and materials that match a pattern. \throws InputError when a pattern matches nothing.
struct Meant {
  std::vector<bool> groups;
  std::vector<bool> materials;
  bool operator()(const Polygon& polygon) const { return groups[polygon.group] || materials[polygon.material]; }
};

Meant meant(const Scene& scene, const std::vector<std::string>& patterns, const std::string& where) {
  Meant all{std::vector<bool>(scene.groups.size()), std::vector<bool>(scene.materials.size())};
  for (const std::string& pattern : patterns) {
    bool found = false;
    for (std::uint32_t group = 0; group < scene.groups.size(); ++group) {
      if (!matches(group_name(scene, group), pattern)) continue;
      all.groups[group] = found = true;
    }
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
      if (!matches(scene.materials[material].name, pattern)) continue;
      all.materials[material] = found = true;
    }
    if (found) continue;
    std::set<std::string> names;
    for (const Material& material : scene.materials) names.insert(material.name);
    refuse_pattern(scene, std::move(names), "object, group or material", pattern, where);
  }
  return all;
}

std::string note_on_rest(const Scene& scene, const std::vector<bool>& stays) {
  std::set<std::uint32_t> groups;
  std::size_t faces = 0;
  double area = 0, all = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const double own = area_of(scene, p);
    all += own;
    if (stays[p]) continue;
    area += own;
    ++faces;
    groups.insert(scene.polygons[p].group);
  }
  return std::to_string(faces) + (faces == 1 ? " face of " : " faces of ") + std::to_string(groups.size()) +
         (groups.size() == 1 ? " object, " : " objects, ") + rounded(100 * area / all, 2) +
         " % of the area, are left out as requested";
}

}  // namespace

bool is_share(MaterialSetting::Quantity quantity) {
  return quantity == Quantity::reflectance || quantity == Quantity::specular_reflectance ||
         quantity == Quantity::transmittance || quantity == Quantity::diffuse_transmittance;
}

bool is_index(const Spectrum& value) { return value.size() == 1 && value[0] >= 1; }

bool matches(std::string_view name, std::string_view pattern) {
  // Position of the last star in the pattern, and the number of letters that it matches. After a mismatch it takes one
  // letter more.
  std::size_t n = 0, p = 0, taken = 0, star = std::string_view::npos;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++n, ++p;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      n = ++taken;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

Scene with_settings(Scene scene, const std::vector<MaterialSetting>& settings) {
  std::vector<std::vector<std::size_t>> meant;  // materials of each setting
  for (const MaterialSetting& setting : settings) {
    if (setting.of.empty()) {
      meant.push_back(chosen(scene.materials, setting));
    } else {
      const std::vector<bool> faces = faces_of(scene, setting.of, setting.where);
      std::vector<std::size_t> materials = chosen(scene.materials, materials_of(scene, faces), setting);
      OwnMaterials own = with_own_materials(std::move(scene), faces, std::move(materials), setting.of);
      scene = std::move(own.scene);
      meant.push_back(std::move(own.materials));
    }
    for (const std::size_t m : meant.back()) scene.materials[m] = changed(scene.materials[m], setting, bands_of(scene));
  }
  for (std::size_t k = 0; k < settings.size(); ++k) require_transmittance(scene.materials, meant[k], settings[k]);
  return scene;
}

MaterialSetting parse_material_setting(const std::string& text) {
  // Names may hold dots and equal signs; the value holds no equal sign and the quantity no dot.
  const std::size_t equals = text.rfind('=');
  const std::size_t dot = equals == std::string::npos ? equals : text.rfind('.', equals);
  if (dot == std::string::npos || dot == 0) {
    refuse_setting(text, std::string("expected MATERIAL.QUANTITY=R,G,B with QUANTITY ") + settable);
  }
  MaterialSetting setting;
  setting.material = text.substr(0, dot);
  setting.quantity = quantity_named(text.substr(dot + 1, equals - dot - 1), text);
  setting.value = comma_separated(text.substr(equals + 1), text, setting.quantity);
  if ((setting.value < 0).any()) refuse_setting(text, "a value is negative; expected 0 or more");
  if (is_share(setting.quantity) && (setting.value > 1).any()) {
    refuse_setting(text, "a reflectance or transmittance is above 1; expected 0 to 1");
  }
  if (setting.quantity == Quantity::index && !is_index(setting.value))
    refuse_setting(text, std::string("an index of refraction is ") + expected_index);
  return setting;
}

Scene with_chosen_faces(Scene scene, const FaceChoice& choice, const std::string& where) {
  if (choice.only.empty() && choice.leave_out.empty()) return scene;
  const Meant only = meant(scene, choice.only, where + ".only");
  const Meant leave_out = meant(scene, choice.leave_out, where + ".leave_out");
  std::vector<bool> stays;
  for (const Polygon& polygon : scene.polygons)
    stays.push_back((choice.only.empty() || only(polygon)) && !leave_out(polygon));
  if (std::find(stays.begin(), stays.end(), true) == stays.end())
    throw InputError(where + (choice.leave_out.empty() ? ".only" : ".leave_out"),
                     "no face remains; expected at least one");
  if (std::find(stays.begin(), stays.end(), false) == stays.end()) return scene;
  scene.diagnostics.push_back({DiagnosticCode::reduced_model, note_on_rest(scene, stays)});
  std::vector<Polygon> polygons;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (stays[p]) polygons.push_back(std::move(scene.polygons[p]));
  }
  scene.polygons = std::move(polygons);
  return with_used_materials(std::move(scene));
}

}  // namespace patchlight
