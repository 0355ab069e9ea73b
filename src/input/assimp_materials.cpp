#include "input/assimp_materials.h"

#include "base/rounded.h"
#include "input/materials.h"
#include "input/stated_panes.h"
#include "input/texture_maps.h"

#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

Spectrum color(const aiMaterial& material, const char* key, double otherwise) {
  aiColor3D found;
  if (material.Get(key, 0, 0, found) != aiReturn_SUCCESS) return rgb(otherwise, otherwise, otherwise);
  return rgb(found.r, found.g, found.b);
}

// Besides that of the diffuse colour.
bool has_other_texture(const aiMaterial& material) {
  for (int type = aiTextureType_DIFFUSE + 1; type <= AI_TEXTURE_TYPE_MAX; ++type) {
    if (material.GetTextureCount(static_cast<aiTextureType>(type)) > 0) return true;
  }
  return false;
}

double number_or(const aiMaterial& material, const char* key, double otherwise) {
  float found = 0;
  return material.Get(key, 0, 0, found) == aiReturn_SUCCESS ? found : otherwise;
}

// What goes through: in COLLADA by the transparent colour (opaque="RGB_ZERO"), whose luminance the opacity has already.
Spectrum let_through(const aiMaterial& material, double opacity) {
  const Spectrum filter = color(material, "$clr.transparent", 1).max(0);
  const double luminance = 0.212671 * filter[0] + 0.715160 * filter[1] + 0.072169 * filter[2];
  if ((filter == filter[0]).all() || !(luminance > 0)) return Spectrum::Constant(3, 1 - opacity);
  return (1 - opacity) / luminance * filter;
}

// A picture stands in the place of the diffuse colour, for which assimp then tells 1.
Material with_place_for_picture(Material material, const AssimpPicture& picture) {
  const Spectrum grey = default_material().reflectance;
  const auto value = static_cast<float>(grey[0]);
  material.reflectance = grey;
  material.texture = {std::make_shared<const Texture>(Texture{1, 1, {{value, value, value}}}),
                      primaries_times(rgb(1, 1, 1)), picture.wrap};
  return material;
}

Material assimp_material(const aiMaterial& read, const AssimpPictures& pictures, unsigned int index) {
  aiString name;
  read.Get(AI_MATKEY_NAME, name);
  // Exitance = pi radiance for a Lambertian emitter.
  Material material{name.C_Str(), color(read, "$clr.diffuse", 0.5), std::numbers::pi * color(read, "$clr.emissive", 0)};
  const auto picture = pictures.find(index);
  if (picture != pictures.end()) material = with_place_for_picture(std::move(material), picture->second);
  const double opacity = number_or(read, "$mat.opacity", 1);
  if (!(opacity >= 0 && opacity < 1)) return material;
  return as_pane(std::move(material), let_through(read, opacity),
                 plausible_index(number_or(read, "$mat.refracti", usual_index)), "opacity " + rounded(opacity));
}

bool is_used(const aiScene& model, unsigned int material) {
  for (unsigned int m = 0; m < model.mNumMeshes; ++m) {
    if (model.mMeshes[m]->mMaterialIndex == material) return true;
  }
  return false;
}

}  // namespace

Scene with_assimp_materials(Scene scene, const aiScene& model, const AssimpPictures& pictures) {
  std::vector<std::string> ignored;
  for (unsigned int m = 0; m < model.mNumMaterials; ++m) {
    const aiMaterial& read = *model.mMaterials[m];
    scene.materials.push_back(assimp_material(read, pictures, m));
    if (is_used(model, m) && has_other_texture(read)) ignored.push_back(scene.materials.back().name);
  }
  if (!pictures.empty()) scene.inputs.resize(scene.materials.size());
  for (const auto& [m, picture] : pictures) scene.inputs[m] = picture.file;
  for (std::string& note : note_on("textures of other than diffuse colours are ignored", ignored))
    scene.notes.push_back(std::move(note));
  return scene;
}

}  // namespace patchlight
