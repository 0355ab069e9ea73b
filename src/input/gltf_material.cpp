#include "input/gltf_material.h"

#include "base/rounded.h"
#include "input/gltf_texture.h"
#include "input/materials.h"
#include "input/stated_mirrors.h"
#include "input/stated_panes.h"
#include "input/texture_maps.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

Spectrum color(const std::vector<double>& factor, double otherwise) {
  return factor.size() >= 3 ? rgb(factor[0], factor[1], factor[2]) : rgb(otherwise, otherwise, otherwise);
}

// The image that a texture shows; -1 when there is none that glTF 2.0 itself defines.
int image_of(const tinygltf::Model& model, int texture) {
  const bool exists = texture >= 0 && static_cast<std::size_t>(texture) < model.textures.size();
  return exists ? model.textures[static_cast<std::size_t>(texture)].source : -1;
}

// The mean colour of a texture; nothing when it is unknown.
std::optional<Spectrum> texture_color(const GltfModel& gltf, int texture) {
  const auto found = gltf.mean_color.find(image_of(gltf.model, texture));
  if (found == gltf.mean_color.end()) return std::nullopt;
  return found->second;
}

Spectrum with_texture(const Spectrum& factor, const GltfModel& gltf, int texture) {
  const std::optional<Spectrum> mean = texture_color(gltf, texture);
  return mean ? Spectrum(factor * *mean) : factor;
}

// A number of an extension of the material, or what holds without it.
double number_of(const tinygltf::Material& material, const char* extension, const char* key, double otherwise) {
  const auto found = material.extensions.find(extension);
  if (found == material.extensions.end() || !found->second.Has(key)) return otherwise;
  return found->second.Get(key).GetNumberAsDouble();
}

double emissive_strength(const tinygltf::Material& material) {
  return number_of(material, "KHR_materials_emissive_strength", "emissiveStrength", 1);
}

// KHR_materials_transmission.
double transmission(const tinygltf::Material& material) {
  return std::clamp(number_of(material, "KHR_materials_transmission", "transmissionFactor", 0), 0.0, 1.0);
}

// The share of the surface that is there: glTF 2.0 section 3.9.4.
double coverage(const tinygltf::Material& material) {
  const std::vector<double>& factor = material.pbrMetallicRoughness.baseColorFactor;
  return material.alphaMode == "BLEND" && factor.size() == 4 ? std::clamp(factor[3], 0.0, 1.0) : 1;
}

// KHR_materials_ior, which says that 1.5 holds without it.
double index_of(const tinygltf::Material& material) {
  constexpr double usual = 1.5;
  return plausible_index(number_of(material, "KHR_materials_ior", "ior", usual), usual);
}

// "transmissionFactor 0.9", "alpha 0.3", or both.
std::string statement_of(double transmitted, double covered) {
  const std::string factor = transmitted > 0 ? "transmissionFactor " + rounded(transmitted) : "";
  const std::string alpha = covered < 1 ? "alpha " + rounded(covered) : "";
  return factor + (factor.empty() || alpha.empty() ? "" : " and ") + alpha;
}

bool is_clear(const tinygltf::Material& material) { return transmission(material) > 0 || coverage(material) < 1; }

// A smooth metal. Both factors are 1 where they are not stated.
bool is_mirror(const tinygltf::Material& material) {
  const tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
  return surface.metallicFactor >= least_metallic && surface.roughnessFactor <= most_roughness &&
         surface.metallicRoughnessTexture.index < 0 && !is_clear(material);
}

// glTF 2.0 appendix B.2: a metal reflects its base colour, and nothing diffusely.
Material with_metal(Material material, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const Spectrum color = material.reflectance;
  return as_mirror(
      std::move(material), color, Spectrum::Zero(color.size()),
      "metallicFactor " + rounded(surface.metallicFactor) + " and roughnessFactor " + rounded(surface.roughnessFactor));
}

// What is covered reflects the part of the base colour that it does not transmit, KHR_materials_transmission says, and
// transmits the other part, but for what the surfaces of glass reflect even if it absorbs nothing.
Material with_transparency(Material material, const tinygltf::Material& read) {
  const double transmitted = transmission(read);
  const double covered = coverage(read);
  const double index = index_of(read);
  const Spectrum color = material.reflectance.min(1);
  const Spectrum clear = (transmitted * color).min(highest_transmittance(index));
  Material pane =
      as_pane(std::move(material), 1 - covered + covered * clear, index, statement_of(transmitted, covered));
  pane.reflectance = covered * (1 - transmitted) * color;
  return pane;
}

// The picture of the base colour where it has more than one colour.
std::optional<TexturedReflectance> textured(const GltfModel& gltf, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const auto found = gltf.textures.find(image_of(gltf.model, surface.baseColorTexture.index));
  if (found == gltf.textures.end()) return std::nullopt;
  return TexturedReflectance{found->second, primaries_times(color(surface.baseColorFactor, 1)),
                             gltf_wrap(gltf.model, surface.baseColorTexture.index)};
}

Material material_from(const GltfModel& gltf, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const Spectrum radiance = emissive_strength(read) * color(read.emissiveFactor, 0);
  // Exitance = pi radiance for a Lambertian emitter.
  Material material{read.name, with_texture(color(surface.baseColorFactor, 1), gltf, surface.baseColorTexture.index),
                    std::numbers::pi * with_texture(radiance, gltf, read.emissiveTexture.index)};
  material.texture = textured(gltf, read);
  if (is_mirror(read)) return with_metal(std::move(material), read);
  return is_clear(read) ? with_transparency(std::move(material), read) : material;
}

// The two textures that count; -1 stands for none.
std::vector<int> colored_textures(const tinygltf::Material& material) {
  std::vector<int> textures;
  for (const int texture : {material.pbrMetallicRoughness.baseColorTexture.index, material.emissiveTexture.index}) {
    if (texture >= 0) textures.push_back(texture);
  }
  return textures;
}

bool is_matt_metal(const tinygltf::Material& material) {
  return material.pbrMetallicRoughness.metallicFactor > 0 && !is_mirror(material);
}

// Transparent by a picture, or where one is below a threshold.
bool has_cut_outs(const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_transmission");
  const bool has_picture = found != material.extensions.end() && found->second.Has("transmissionTexture");
  const bool is_blended = material.alphaMode == "BLEND" && material.pbrMetallicRoughness.baseColorTexture.index >= 0;
  return material.alphaMode == "MASK" || is_blended || has_picture;
}

std::vector<std::string> names_with(const tinygltf::Model& model,
                                    const std::function<bool(const tinygltf::Material&)>& property) {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    const std::string& name = model.materials[m].name;
    if (property(model.materials[m])) names.push_back(name.empty() ? "material " + std::to_string(m) : name);
  }
  return names;
}

}  // namespace

std::vector<Material> gltf_materials(const GltfModel& gltf) {
  std::vector<Material> materials;
  for (const tinygltf::Material& read : gltf.model.materials) materials.push_back(material_from(gltf, read));
  return materials;
}

std::vector<UnsimulatedMaterials> unsimulated(const GltfModel& gltf) {
  return counted(names_with(gltf.model, is_matt_metal).size(), names_with(gltf.model, has_cut_outs).size());
}

std::vector<std::string> notes_on_materials(const GltfModel& gltf) {
  std::vector<std::string> notes;
  const auto note = [&](const std::string& sentence, const std::function<bool(const tinygltf::Material&)>& property) {
    for (std::string& text : note_on(sentence, names_with(gltf.model, property))) notes.push_back(std::move(text));
  };
  const auto has_texture = [&](bool is_decoded) {
    return [&gltf, is_decoded](const tinygltf::Material& material) {
      for (const int texture : colored_textures(material)) {
        if (texture_color(gltf, texture).has_value() == is_decoded) return true;
      }
      return false;
    };
  };
  const auto is_used_whole = [&](const tinygltf::Material& material) {
    const bool has_place = !is_clear(material) && !is_mirror(material);
    const bool has_mean = texture_color(gltf, material.pbrMetallicRoughness.baseColorTexture.index).has_value();
    return (has_mean && !has_place) || texture_color(gltf, material.emissiveTexture.index).has_value();
  };
  note("textures of lamps, panes and mirrors are replaced by their mean colour", is_used_whole);
  for (const auto& [image, fault] : gltf.picture_faults) {
    const tinygltf::Image& found = gltf.model.images[static_cast<std::size_t>(image)];
    const std::string name = found.uri.empty() ? found.name : found.uri;
    notes.push_back("image " + std::to_string(image) + (name.empty() ? "" : " (" + name.substr(0, 80) + ")") + " " +
                    fault);
  }
  note("textures that could not be read are ignored, the colour factor is used alone", has_texture(false));
  note("metallic surfaces are simulated as matt ones of their base colour", is_matt_metal);
  note("transparency by textures and masks is ignored, factors alone count", has_cut_outs);
  return notes;
}

}  // namespace patchlight
