#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads a glTF 2.0 file (.gltf with its buffers and textures, or .glb): triangles, transformations, base colours and
/// emission. Up is y.
/// \throws InputError naming the file.
Scene read_gltf(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
