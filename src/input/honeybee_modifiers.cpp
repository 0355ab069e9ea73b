#include "input/honeybee_modifiers.h"

#include "base/lower_case.h"
#include "input/radiance_material.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

using HoneybeeJson = nlohmann::json;

double number_in(const HoneybeeJson& item, const std::string& key, double otherwise) {
  const auto found = item.find(key);
  return found != item.end() && found->is_number() ? found->get<double>() : otherwise;
}

// "r_reflectance" and so on.
Spectrum bands_of_key(const HoneybeeJson& item, const std::string& quantity, double otherwise) {
  return rgb(number_in(item, "r_" + quantity, otherwise), number_in(item, "g_" + quantity, otherwise),
             number_in(item, "b_" + quantity, otherwise));
}

std::string text_in(const HoneybeeJson& item, const std::string& key) {
  const auto found = item.find(key);
  return found != item.end() && found->is_string() ? found->get<std::string>() : std::string();
}

// Transmissivity 0.88 of an interior window and 0.64 of others.
const std::map<std::string, std::pair<double, double>>& generic_values() {
  static const std::map<std::string, std::pair<double, double>> values = {
      {"floor", {0.2, 0}},           {"wall", {0.5, 0}},
      {"ceiling", {0.8, 0}},         {"door", {0.5, 0}},
      {"window", {0, 0.64}},         {"interior_window", {0, 0.88}},
      {"exterior_shade", {0.35, 0}}, {"interior_shade", {0.5, 0}},
      {"context", {0.2, 0}}};
  return values;
}

Material generic_material(const std::string& kind) {
  constexpr double usual = 1.52;
  const auto [reflectance, transmittance] = generic_values().at(kind);
  Material material{"generic_" + kind, rgb(reflectance, reflectance, reflectance), rgb(0, 0, 0)};
  if (transmittance > 0) {
    material.transmittance = rgb(transmittance, transmittance, transmittance);
    material.index = usual;
  }
  return material;
}

// As Radiance has them; nothing for kinds that are not known.
std::optional<Material> material_of(const HoneybeeJson& modifier) {
  const std::string type = in_lower_case(text_in(modifier, "type"));
  const std::string name = text_in(modifier, "identifier");
  const Spectrum reflectance = bands_of_key(modifier, "reflectance", 0);
  const double roughness = number_in(modifier, "roughness", 0);
  if (type == "plastic") return plastic(name, reflectance, number_in(modifier, "specularity", 0));
  if (type == "metal") return metal(name, reflectance, number_in(modifier, "specularity", 0.9), roughness);
  if (type == "mirror") return metal(name, reflectance, 1, roughness);
  if (type == "glass")
    return glass(name, bands_of_key(modifier, "transmissivity", 0),
                 number_in(modifier, "refraction_index", usual_index));
  if (type == "trans") {
    return translucent(name, reflectance, number_in(modifier, "specularity", 0),
                       number_in(modifier, "transmitted_diff", 0), number_in(modifier, "transmitted_spec", 0));
  }
  if (type == "light" || type == "glow") return emitter(name, bands_of_key(modifier, "emittance", 0));
  return std::nullopt;
}

// Where a modifier set has the modifier of a kind: its part, and the keys there of what stands outdoors and of other.
struct PlaceInSet {
  const char* part;
  const char* outdoors;
  const char* other;
};

const std::map<std::string, PlaceInSet>& places_in_sets() {
  static const std::map<std::string, PlaceInSet> places = {
      {"floor", {"floor_set", "exterior_modifier", "interior_modifier"}},
      {"wall", {"wall_set", "exterior_modifier", "interior_modifier"}},
      {"ceiling", {"roof_ceiling_set", "exterior_modifier", "interior_modifier"}},
      {"door", {"door_set", "exterior_modifier", "interior_modifier"}},
      {"glass_door", {"door_set", "exterior_glass_modifier", "interior_glass_modifier"}},
      {"window", {"aperture_set", "window_modifier", "interior_modifier"}},
      {"operable_window", {"aperture_set", "operable_modifier", "interior_modifier"}},
      {"skylight", {"aperture_set", "skylight_modifier", "interior_modifier"}},
      {"exterior_shade", {"shade_set", "exterior_modifier", "exterior_modifier"}},
      {"interior_shade", {"shade_set", "interior_modifier", "interior_modifier"}}};
  return places;
}

bool is_outdoors(const HoneybeeJson& item) {
  const HoneybeeJson::json_pointer place("/boundary_condition/type");
  return item.contains(place) && item.at(place) == "Outdoors";
}

// Where honeybee has one generic modifier for several kinds.
std::string generic_kind(const std::string& kind, bool outdoors) {
  const bool is_glass = kind == "window" || kind == "operable_window" || kind == "skylight" || kind == "glass_door";
  if (is_glass) return outdoors ? "window" : "interior_window";
  return kind;
}

}  // namespace

HoneybeeModifiers::HoneybeeModifiers(const nlohmann::json& radiance) : radiance_(radiance) {}

const nlohmann::json* HoneybeeModifiers::modifier(const std::string& identifier) const {
  const auto list = radiance_.find("modifiers");
  if (list == radiance_.end()) return nullptr;
  for (const HoneybeeJson& one : *list) {
    if (text_in(one, "identifier") == identifier) return &one;
  }
  return nullptr;
}

std::string HoneybeeModifiers::of_set(const std::string& set, const std::string& kind, bool outdoors) const {
  const auto sets = radiance_.find("modifier_sets");
  const auto place = places_in_sets().find(kind);
  if (set.empty() || sets == radiance_.end() || place == places_in_sets().end()) return {};
  for (const HoneybeeJson& one : *sets) {
    if (text_in(one, "identifier") != set) continue;
    const auto part = one.find(place->second.part);
    if (part == one.end() || !part->is_object()) return {};
    return text_in(*part, outdoors ? place->second.outdoors : place->second.other);
  }
  return {};
}

Material HoneybeeModifiers::material(const nlohmann::json& item, const std::string& set, const std::string& kind) {
  const HoneybeeJson::json_pointer own("/properties/radiance/modifier");
  std::string name = item.contains(own) && item.at(own).is_string() ? item.at(own).get<std::string>() : std::string();
  const bool outdoors = is_outdoors(item);
  const std::string generic = generic_kind(kind, outdoors);
  if (name.empty()) name = of_set(set, kind, outdoors);
  if (name.empty()) return generic_material(generic);
  const HoneybeeJson* const found = modifier(name);
  const std::optional<Material> material = found != nullptr ? material_of(*found) : std::nullopt;
  if (material) return *material;
  if (std::find(unknown_.begin(), unknown_.end(), name) == unknown_.end()) unknown_.push_back(name);
  return generic_material(generic);
}

}  // namespace patchlight
