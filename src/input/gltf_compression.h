#pragma once

#include <string>
#include <tiny_gltf.h>

namespace patchlight {

/// The bytes of a .gltf or .glb file with compressed parts without what tinygltf refuses in them: buffers that are in
/// no file, for what EXT_meshopt_compression unpacks, are made empty, and triangles in KHR_draco_mesh_compression name
/// no indices. Other files as they are.
std::string readable_gltf(const std::string& bytes);

/// The model with its compressed parts unpacked: views of buffers by EXT_meshopt_compression, positions and triangles
/// of primitives by KHR_draco_mesh_compression. \throws InputError naming `file` where they are damaged.
tinygltf::Model decompressed(tinygltf::Model model, const std::string& file);

}  // namespace patchlight
