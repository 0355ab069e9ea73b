#pragma once

#include "patchlight/light/material.h"

#include <Eigen/Core>
#include <array>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace patchlight {

/// How a texture's sampler goes on beyond its edges: glTF 2.0 section 3.8.3. Repeated where nothing is said.
std::array<Wrap, 2> gltf_wrap(const tinygltf::Model& model, int texture);

/// Where the vertices of a primitive lie in a texture: its set of coordinates, changed by KHR_texture_transform. Empty
/// where it has no such set. \throws InputError as accessor_values() does.
std::vector<Eigen::Vector2d> gltf_places(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         const tinygltf::TextureInfo& texture, const std::string& file);

}  // namespace patchlight
