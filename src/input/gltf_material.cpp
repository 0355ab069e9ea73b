#include "input/gltf_material.h"

#include "input/materials.h"

#include <functional>
#include <numbers>
#include <optional>

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

// KHR_materials_emissive_strength; 1 without it.
double emissive_strength(const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_emissive_strength");
  if (found == material.extensions.end() || !found->second.Has("emissiveStrength")) return 1;
  return found->second.Get("emissiveStrength").GetNumberAsDouble();
}

Material material_from(const GltfModel& gltf, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const Spectrum radiance = emissive_strength(read) * color(read.emissiveFactor, 0);
  // Exitance = pi radiance for a Lambertian emitter.
  return {read.name, with_texture(color(surface.baseColorFactor, 1), gltf, surface.baseColorTexture.index),
          std::numbers::pi * with_texture(radiance, gltf, read.emissiveTexture.index)};
}

// The two textures that count; -1 stands for none.
std::vector<int> colored_textures(const tinygltf::Material& material) {
  std::vector<int> textures;
  for (const int texture : {material.pbrMetallicRoughness.baseColorTexture.index, material.emissiveTexture.index}) {
    if (texture >= 0) textures.push_back(texture);
  }
  return textures;
}

bool is_metallic(const tinygltf::Material& material) { return material.pbrMetallicRoughness.metallicFactor > 0; }

bool is_transparent(const tinygltf::Material& material) {
  return material.alphaMode == "BLEND" || material.alphaMode == "MASK" ||
         material.extensions.count("KHR_materials_transmission") > 0;
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
  return counted(names_with(gltf.model, is_metallic).size(), names_with(gltf.model, is_transparent).size());
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
  note("textures are replaced by their mean colour", has_texture(true));
  note("textures that could not be read are ignored, the colour factor is used alone", has_texture(false));
  note("metallic surfaces are simulated as matt ones of their base colour", is_metallic);
  note("transparency is ignored, the surface is opaque", is_transparent);
  return notes;
}

}  // namespace patchlight
