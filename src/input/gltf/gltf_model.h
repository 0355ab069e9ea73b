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

/// The files that a glTF file is made of: itself, its buffers and its pictures.
struct GltfFiles {
  std::filesystem::path confine;  ///< the folder in which they must lie; empty for any
  std::vector<std::filesystem::path> names;
  std::vector<std::string> bytes;  ///< for the checksum
};

/// A glTF file as tinygltf reads it.
struct GltfModel {
  tinygltf::Model model;
  std::map<int, Spectrum> mean_color;  ///< linear RGB of those images that could be decoded, by index
  std::map<int, std::shared_ptr<const Texture>> textures;    ///< those of them with more than one color
  std::map<int, std::shared_ptr<const AlphaColours>> alpha;  ///< those of them that are not opaque all over
  std::map<int, std::string> picture_faults;                 ///< why the others could not
  GltfFiles files;
};

/// Reads a .gltf or .glb file and its buffers and pictures. \throws InputError naming the file: not glTF 2.0, a buffer
/// is missing or compressed and damaged, or the file requires an extension that is not known; or a file does not lie in
/// the folder `confine`, if there is one.
GltfModel read_gltf_model(const std::filesystem::path& file, const std::filesystem::path& confine);

/// The values of an accessor, `components` per element, normalized integers converted as glTF 2.0 section 3.11 says.
/// \throws InputError naming `file` when there is no such accessor, it has another type or leaves its buffer.
std::vector<double> accessor_values(const tinygltf::Model& model, int accessor, int components,
                                    const std::string& file);

/// How a texture's sampler goes on beyond its edges: glTF 2.0 section 3.8.3. Repeated where nothing is said.
std::array<Wrap, 2> gltf_wrap(const tinygltf::Model& model, int texture);

/// Where the vertices of a primitive lie in a texture: its set of coordinates, changed by KHR_texture_transform. Empty
/// where it has no such set. \throws InputError as accessor_values() does.
std::vector<Eigen::Vector2d> gltf_places(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         const tinygltf::TextureInfo& texture, const std::string& file);

}  // namespace patchlight
