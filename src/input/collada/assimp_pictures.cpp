#include "input/collada/assimp_pictures.h"

#include <algorithm>
#include <optional>

namespace patchlight {
namespace {

Wrap wrap_of_mode(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Mirror) return Wrap::mirror;
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? Wrap::clamp : Wrap::repeat;
}

std::optional<AssimpPicture> diffuse_picture(const aiMaterial& material, const std::filesystem::path& folder) {
  aiString name;
  unsigned int set = 0;
  std::array<aiTextureMapMode, 3> modes = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name, nullptr, &set, nullptr, nullptr, modes.data()) !=
      aiReturn_SUCCESS)
    return std::nullopt;
  std::string file = name.C_Str();
  std::replace(file.begin(), file.end(), '\\', '/');
  return AssimpPicture{(folder / file).string(), set, {wrap_of_mode(modes[0]), wrap_of_mode(modes[1])}};
}

}  // namespace

AssimpPictures diffuse_pictures(const aiScene& model, const std::filesystem::path& folder) {
  AssimpPictures pictures;
  for (unsigned int m = 0; m < model.mNumMeshes; ++m) {
    const unsigned int material = model.mMeshes[m]->mMaterialIndex;
    const std::optional<AssimpPicture> picture = diffuse_picture(*model.mMaterials[material], folder);
    if (picture) pictures.emplace(material, *picture);
  }
  return pictures;
}

std::vector<Eigen::Vector2d> places_in(const AssimpPicture& picture, const aiMesh& mesh) {
  std::vector<Eigen::Vector2d> places;
  if (picture.set >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh.HasTextureCoords(picture.set)) return places;
  for (unsigned int v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& place = mesh.mTextureCoords[picture.set][v];
    places.emplace_back(place.x, 1.0 - place.y);
  }
  return places;
}

}  // namespace patchlight
