#include "input/radiance/radiance_material.h"

#include "input/materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

Material black(std::string name) { return {std::move(name), rgb(0, 0, 0), rgb(0, 0, 0)}; }

Spectrum colour_in(const std::vector<double>& numbers) { return rgb(numbers[0], numbers[1], numbers[2]); }

const char* const matt_gloss = "gloss becomes matt";

RadianceMaterial translucent_of(const std::string& name, const std::vector<double>& numbers, std::size_t transmitted) {
  const double gloss = numbers[3];
  const double through = numbers[transmitted];
  const double straight = numbers[transmitted + 1];
  std::string simplified;
  if (through > 0 && straight > 0 && straight < 1)
    simplified = straight > 0.5 ? "scattered transmitted light is lost" : "directly transmitted light is lost";
  if (gloss > 0) simplified += (simplified.empty() ? "" : ", ") + std::string(matt_gloss);
  return {translucent(name, colour_in(numbers), gloss, through, straight), simplified};
}

// A solid body of glass; two parallel faces of a sheet count as one pane.
RadianceMaterial body_of_glass(const std::string& name, double stated_index) {
  const double index = plausible_index(stated_index);
  Material material = black(name);
  const double share = highest_transmittance(index);
  material.transmittance = rgb(share, share, share);
  material.index = index;
  return {material, "absorption and refraction are ignored: its surfaces are thin clear panes"};
}

RadianceMaterial glossy(const std::string& kind, const std::string& name, const std::vector<double>& numbers) {
  const double gloss = numbers[3];
  const double roughness = numbers[4];
  if (kind == "plastic" || kind == "plastic2")
    return {plastic(name, colour_in(numbers), gloss), gloss > 0 ? matt_gloss : ""};
  return {metal(name, colour_in(numbers), gloss, roughness), gloss > 0 && roughness > 0 ? matt_gloss : ""};
}

RadianceMaterial light_of(const std::string& kind, const std::string& name, const std::vector<double>& numbers) {
  if (kind == "spotlight")
    return {black(name), "its beam is not supported and emits nothing: use a [[luminaire]] of kind \"spot\"", true};
  if (kind == "glow" && numbers[3] < 0) return {black(name), "it gives no light, as its radius is negative"};
  return {emitter(name, colour_in(numbers)), kind == "illum" ? "it emits evenly, as a light does" : ""};
}

constexpr std::array pattern_kinds = {"brightdata", "brightfunc", "brighttext", "colordata", "colorfunc",
                                      "colorpict",  "colortext",  "texdata",    "texfunc"};

bool is_pattern(const RadianceModifier& modifier) {
  return std::find(pattern_kinds.begin(), pattern_kinds.end(), modifier.kind) != pattern_kinds.end();
}

void require_numbers(const RadiancePrimitive& primitive, const std::string& where) {
  const std::size_t least = least_arguments(primitive.kind);
  if (primitive.numbers.size() >= least) return;
  throw InputError(where, primitive.kind + " " + primitive.name + " has " + std::to_string(primitive.numbers.size()) +
                              " numbers; expected " + std::to_string(least));
}

}  // namespace

Material plastic(std::string name, const Spectrum& reflectance, double specularity) {
  Material material = black(std::move(name));
  material.reflectance = reflectance * (1 - specularity) + specularity;
  return material;
}

Material metal(std::string name, const Spectrum& reflectance, double specularity, double roughness) {
  Material material = black(std::move(name));
  const bool is_smooth = roughness == 0;
  material.reflectance = reflectance * (is_smooth ? 1 - specularity : 1);
  if (is_smooth && specularity > 0) material.specular_reflectance = reflectance * specularity;
  return material;
}

Material glass(std::string name, const Spectrum& transmissivity, double index) {
  const double r = std::pow((index - 1) / (index + 1), 2);
  Material material = black(std::move(name));
  material.index = index;
  material.transmittance = transmissivity * std::pow(1 - r, 2) / (1 - (r * transmissivity).square());
  return material;
}

Material translucent(std::string name, const Spectrum& colour, double specularity, double transmitted,
                     double straight) {
  Material material = black(std::move(name));
  const Spectrum scattered = colour * (1 - specularity);
  material.reflectance = scattered * (1 - transmitted) + specularity;
  if (straight > 0.5) {
    material.transmittance = scattered * transmitted * straight;
  } else if (transmitted > 0) {
    material.diffuse_transmittance = scattered * transmitted * (1 - straight);
  }
  return material;
}

Material emitter(std::string name, const Spectrum& radiance) {
  Material material = black(std::move(name));
  material.exitance = std::numbers::pi * radiance;  // E = pi L
  return material;
}

std::optional<RadianceMaterial> radiance_material(const std::string& kind, const std::string& name,
                                                  const std::vector<double>& numbers) {
  if (kind == "plastic" || kind == "metal" || kind == "plastic2" || kind == "metal2")
    return glossy(kind, name, numbers);
  if (kind == "trans") return translucent_of(name, numbers, 5);
  if (kind == "trans2") return translucent_of(name, numbers, 6);
  if (kind == "mirror") return RadianceMaterial{metal(name, colour_in(numbers), 1, 0), ""};
  if (kind == "glass")
    return RadianceMaterial{glass(name, colour_in(numbers), numbers.size() > 3 ? numbers[3] : usual_index), ""};
  if (kind == "dielectric") return body_of_glass(name, numbers[3]);
  if (kind == "light" || kind == "glow" || kind == "illum" || kind == "spotlight") return light_of(kind, name, numbers);
  return std::nullopt;
}

std::size_t least_arguments(const std::string& kind) {
  static const std::map<std::string, std::size_t> least = {
      {"plastic", 5}, {"metal", 5}, {"plastic2", 6},   {"metal2", 6}, {"trans", 7}, {"trans2", 8},   {"glass", 3},
      {"mirror", 3},  {"light", 3}, {"dielectric", 5}, {"glow", 4},   {"illum", 3}, {"spotlight", 7}};
  const auto found = least.find(kind);
  return found == least.end() ? 0 : found->second;
}

void RadianceModifiers::define(const RadiancePrimitive& primitive, const std::string& where) {
  RadianceModifier modifier{all_.size(), primitive.kind, primitive.name, primitive.numbers};
  if (primitive.kind == "alias") {
    const std::optional<std::size_t> original = place_of(primitive.words[0]);
    if (!original)
      throw InputError(where,
                       "alias " + primitive.name + " stands for " + primitive.words[0] +
                           ", which is not defined before it\nhint: name the file that defines it before this one");
    modifier = all_[*original];
    modifier.name = primitive.name;
    if (modifier.under == *original) modifier.under = all_.size();
  } else {
    require_numbers(primitive, where);
  }
  // An alias keeps the modifier of its original unless it has its own.
  const std::optional<std::size_t> under = place_of(primitive.modifier);
  modifier.under = under.value_or(modifier.under);
  if (under)
    modifier.is_under_unknown = false;
  else if (primitive.modifier != "void" && primitive.modifier != "inherit")
    modifier.is_under_unknown = true;
  last_[primitive.name] = all_.size();
  all_.push_back(std::move(modifier));
}

std::optional<std::size_t> RadianceModifiers::place_of(const std::string& name) const {
  const auto found = last_.find(name);
  return found == last_.end() ? std::nullopt : std::optional(found->second);
}

std::size_t RadianceModifiers::material_below(std::size_t place) const {
  while (is_pattern(all_[place]) && all_[place].under != place) place = all_[place].under;
  return place;
}

bool RadianceModifiers::varies_in_strength(std::size_t place) const {
  for (;; place = all_[place].under) {
    const RadianceModifier& modifier = all_[place];
    const bool is_texture = modifier.kind == "texdata" || modifier.kind == "texfunc";
    if ((is_pattern(modifier) && !is_texture) || modifier.is_under_unknown) return true;
    if (modifier.under == place) return false;
  }
}

bool RadianceModifiers::has_pattern(std::size_t place) const {
  for (;; place = all_[place].under) {
    if (is_pattern(all_[place]) || all_[place].is_under_unknown) return true;
    if (all_[place].under == place) return false;
  }
}

}  // namespace patchlight
