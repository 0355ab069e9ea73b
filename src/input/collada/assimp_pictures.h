#pragma once

#include "patchlight/light/material.h"

#include <Eigen/Core>
#include <array>
#include <assimp/scene.h>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace patchlight {

/// The picture of the diffuse colour of one of assimp's materials.
struct AssimpPicture {
  std::string file;      ///< beside the model, as it names it
  unsigned int set = 0;  ///< of the meshes' coordinates in pictures
  std::array<Wrap, 2> wrap{};
};

/// By the index of the material.
using AssimpPictures = std::map<unsigned int, AssimpPicture>;

/// Those of the materials that meshes use. `folder` is that of the model.
AssimpPictures diffuse_pictures(const aiScene& model, const std::filesystem::path& folder);

/// Where the corners of a mesh lie in a picture, v downwards; empty where it has no such set.
std::vector<Eigen::Vector2d> places_in(const AssimpPicture& picture, const aiMesh& mesh);

}  // namespace patchlight
