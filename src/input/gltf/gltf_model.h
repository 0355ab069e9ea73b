#pragma once

#include "patchlight/light/material.h"

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace patchlight {

struct AlphaColours;

/// The files of a glTF model: the file itself, its buffers and its pictures.
struct GltfFiles {
  std::filesystem::path confine;  ///< the folder that must contain them; empty: no restriction
  std::vector<std::filesystem::path> names;
  std::vector<std::string> bytes;  ///< for the checksum
};

/// A glTF file as read by tinygltf.
struct GltfModel {
  tinygltf::Model model;
  std::map<int, Spectrum> mean_color;                        ///< linear RGB of the decoded images, by index
  std::map<int, std::shared_ptr<const Texture>> textures;    ///< decoded images with more than one color
  std::map<int, std::shared_ptr<const AlphaColours>> alpha;  ///< decoded images that are not opaque
  std::map<int, std::string> picture_faults;                 ///< reasons for images that could not be decoded
  GltfFiles files;
};

/// Reads a .gltf or .glb file with buffers and pictures, all in the folder `confine`, if given.
/// \throws InputError naming the file for other formats, missing or damaged buffers, and unknown required extensions.
GltfModel read_gltf_model(const std::filesystem::path& file, const std::filesystem::path& confine);

/// The values of an accessor, `components` per element; normalized integers are converted by glTF 2.0 section 3.11.
/// \throws InputError naming `file` when the accessor is missing, has another type or exceeds its buffer.
std::vector<double> accessor_values(const tinygltf::Model& model, int accessor, int components,
                                    const std::string& file);

/// Wrap modes of a texture's sampler, glTF 2.0 section 3.8.3; default: repeat.
std::array<Wrap, 2> gltf_wrap(const tinygltf::Model& model, int texture);

/// Texture coordinates of the vertices of a primitive, with KHR_texture_transform applied. Empty without the set of
/// coordinates. \throws InputError as accessor_values().
std::vector<Eigen::Vector2d> gltf_places(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         const tinygltf::TextureInfo& texture, const std::string& file);

}  // namespace patchlight
