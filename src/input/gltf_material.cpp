#include "input/gltf_material.h"

#include "base/rounded.h"
#include "input/gltf_texture.h"
#include "input/materials.h"
#include "input/picture_colours.h"
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

Spectrum color_factor(const tinygltf::Material& material) {
  return color(material.pbrMetallicRoughness.baseColorFactor, 1);
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

// The alpha of the base colour's picture; null where it is 1 all over, or unknown.
const AlphaColours* alpha_picture(const GltfModel& gltf, const tinygltf::Material& material) {
  const int image = image_of(gltf.model, material.pbrMetallicRoughness.baseColorTexture.index);
  const auto found = gltf.alpha.find(image);
  return found == gltf.alpha.end() ? nullptr : found->second.get();
}

double alpha_factor(const tinygltf::Material& material) {
  const std::vector<double>& factor = material.pbrMetallicRoughness.baseColorFactor;
  return factor.size() == 4 ? std::clamp(factor[3], 0.0, 1.0) : 1;
}

// A picture tells where the surface is: glTF 2.0 section 3.9.4.
bool is_cut_out(const GltfModel& gltf, const tinygltf::Material& material) {
  const bool heeds_alpha = material.alphaMode == "MASK" || material.alphaMode == "BLEND";
  return heeds_alpha && alpha_picture(gltf, material);
}

// What is there of it, of the colour of the picture: where alpha reaches the cutoff, or the share alpha of each place.
Coverage cut_out_coverage(const GltfModel& gltf, const tinygltf::Material& material) {
  const double factor = alpha_factor(material);
  const bool is_mask = material.alphaMode == "MASK";
  return coverage_by(*alpha_picture(gltf, material), [&](double alpha) {
    if (is_mask) return alpha * factor >= material.alphaCutoff ? 1.0 : 0.0;
    return alpha * factor;
  });
}

// The share of the surface that is there. A mask without a picture makes it all or nothing: it is there.
double covered_share(const GltfModel& gltf, const tinygltf::Material& material) {
  if (is_cut_out(gltf, material)) return cut_out_coverage(gltf, material).share;
  return material.alphaMode == "BLEND" ? alpha_factor(material) : 1;
}

// KHR_materials_ior, which says that 1.5 holds without it.
double index_of(const tinygltf::Material& material) {
  constexpr double usual = 1.5;
  return plausible_index(number_of(material, "KHR_materials_ior", "ior", usual), usual);
}

// "transmissionFactor 0.9", "alpha 0.3", or both.
std::string statement_of(double transmitted, double covered, bool by_picture) {
  const std::string factor = transmitted > 0 ? "transmissionFactor " + rounded(transmitted) : "";
  const std::string alpha =
      covered < 1 ? (by_picture ? "alpha of its picture covers " : "alpha ") + rounded(covered) : "";
  return factor + (factor.empty() || alpha.empty() ? "" : " and ") + alpha;
}

bool is_clear(const GltfModel& gltf, const tinygltf::Material& material) {
  return transmission(material) > 0 || covered_share(gltf, material) < 1;
}

// A smooth metal. Both factors are 1 where they are not stated.
bool is_mirror(const GltfModel& gltf, const tinygltf::Material& material) {
  const tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
  return surface.metallicFactor >= least_metallic && surface.roughnessFactor <= most_roughness &&
         surface.metallicRoughnessTexture.index < 0 && !is_clear(gltf, material);
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
// Holes alone have no index of refraction: through them light goes as through air.
Material with_transparency(Material material, const GltfModel& gltf, const tinygltf::Material& read) {
  const double transmitted = transmission(read);
  const bool by_picture = is_cut_out(gltf, read);
  const double covered = covered_share(gltf, read);
  const double index = by_picture && transmitted == 0 ? 1 : index_of(read);
  const Spectrum surface =
      by_picture ? Spectrum(color_factor(read) * cut_out_coverage(gltf, read).colour) : material.reflectance;
  const Spectrum color = surface.min(1);
  const Spectrum clear = (transmitted * color).min(highest_transmittance(index));
  Material pane = as_pane(std::move(material), 1 - covered + covered * clear, index,
                          statement_of(transmitted, covered, by_picture));
  pane.reflectance = covered * (1 - transmitted) * color;
  pane.stated_pane->matt_exitance = pane.exitance;
  pane.exitance *= covered;
  return pane;
}

// The picture of the base colour where it has more than one colour.
std::optional<TexturedReflectance> textured(const GltfModel& gltf, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const auto found = gltf.textures.find(image_of(gltf.model, surface.baseColorTexture.index));
  if (found == gltf.textures.end()) return std::nullopt;
  return TexturedReflectance{found->second, primaries_times(color_factor(read)),
                             gltf_wrap(gltf.model, surface.baseColorTexture.index)};
}

Material material_from(const GltfModel& gltf, const tinygltf::Material& read) {
  const int picture = read.pbrMetallicRoughness.baseColorTexture.index;
  const Spectrum radiance = emissive_strength(read) * color(read.emissiveFactor, 0);
  // Exitance = pi radiance for a Lambertian emitter.
  Material material{read.name, with_texture(color_factor(read), gltf, picture),
                    std::numbers::pi * with_texture(radiance, gltf, read.emissiveTexture.index)};
  material.texture = textured(gltf, read);
  if (is_mirror(gltf, read)) return with_metal(std::move(material), read);
  return is_clear(gltf, read) ? with_transparency(std::move(material), gltf, read) : material;
}

// The two textures that count; -1 stands for none.
std::vector<int> colored_textures(const tinygltf::Material& material) {
  std::vector<int> textures;
  for (const int texture : {material.pbrMetallicRoughness.baseColorTexture.index, material.emissiveTexture.index}) {
    if (texture >= 0) textures.push_back(texture);
  }
  return textures;
}

bool is_matt_metal(const GltfModel& gltf, const tinygltf::Material& material) {
  return material.pbrMetallicRoughness.metallicFactor > 0 && !is_mirror(gltf, material);
}

// Transparent by a picture of transmission, or by one that could not be read.
bool has_unknown_holes(const GltfModel& gltf, const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_transmission");
  if (found != material.extensions.end() && found->second.Has("transmissionTexture")) return true;
  if (material.alphaMode != "MASK" && material.alphaMode != "BLEND") return false;
  const int picture = material.pbrMetallicRoughness.baseColorTexture.index;
  return picture >= 0 && !texture_color(gltf, picture);
}

// Nowhere by a mask, as the factor's alpha alone says; more likely the cutoff is not meant.
bool is_masked_away(const GltfModel& gltf, const tinygltf::Material& material) {
  const bool is_gone = material.alphaMode == "MASK" && alpha_factor(material) < material.alphaCutoff;
  return is_gone && !is_cut_out(gltf, material) && !has_unknown_holes(gltf, material);
}

std::string name_of_material(const tinygltf::Model& model, std::size_t m) {
  const std::string& name = model.materials[m].name;
  return name.empty() ? "material " + std::to_string(m) : name;
}

using GltfProperty = std::function<bool(const GltfModel&, const tinygltf::Material&)>;

std::vector<std::string> names_with(const GltfModel& gltf, const GltfProperty& property) {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < gltf.model.materials.size(); ++m)
    if (property(gltf, gltf.model.materials[m])) names.push_back(name_of_material(gltf.model, m));
  return names;
}

// With what their pictures cover: "leaves (0.42)".
std::vector<std::string> covered_shares(const GltfModel& gltf) {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < gltf.model.materials.size(); ++m) {
    const tinygltf::Material& material = gltf.model.materials[m];
    if (!is_cut_out(gltf, material) || covered_share(gltf, material) >= 1) continue;
    names.push_back(name_of_material(gltf.model, m) + " (" + rounded(covered_share(gltf, material)) + ")");
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
  return counted(names_with(gltf, is_matt_metal).size(),
                 names_with(gltf, has_unknown_holes).size() + names_with(gltf, is_masked_away).size());
}

std::vector<std::string> notes_on_materials(const GltfModel& gltf) {
  std::vector<std::string> notes;
  const auto name = [&](const std::string& sentence, const std::vector<std::string>& names) {
    for (std::string& text : note_on(sentence, names)) notes.push_back(std::move(text));
  };
  const auto note = [&](const std::string& sentence, const GltfProperty& property) {
    name(sentence, names_with(gltf, property));
  };
  const auto has_texture = [&](bool is_decoded) {
    return [is_decoded](const GltfModel& of, const tinygltf::Material& material) {
      for (const int texture : colored_textures(material)) {
        if (texture_color(of, texture).has_value() == is_decoded) return true;
      }
      return false;
    };
  };
  const auto is_used_whole = [](const GltfModel& of, const tinygltf::Material& material) {
    const bool has_place = !is_clear(of, material) && !is_mirror(of, material);
    const bool has_mean = texture_color(of, material.pbrMetallicRoughness.baseColorTexture.index).has_value();
    return (has_mean && !has_place) || texture_color(of, material.emissiveTexture.index).has_value();
  };
  note("textures of lamps, panes and mirrors are replaced by their mean colour", is_used_whole);
  for (const auto& [image, fault] : gltf.picture_faults) {
    const tinygltf::Image& found = gltf.model.images[static_cast<std::size_t>(image)];
    const std::string& uri = found.uri.empty() ? found.name : found.uri;
    notes.push_back("image " + std::to_string(image) + (uri.empty() ? "" : " (" + uri.substr(0, 80) + ")") + " " +
                    fault);
  }
  note("textures that could not be read are ignored, the colour factor is used alone", has_texture(false));
  note("metallic surfaces are simulated as matt ones of their base colour", is_matt_metal);
  name(covered_note, covered_shares(gltf));
  note("transparency by textures is ignored, factors alone count", has_unknown_holes);
  note("masks that leave nothing of a surface are ignored: it is opaque", is_masked_away);
  return notes;
}

}  // namespace patchlight
