#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads a glTF 2.0 file (.gltf with its buffers and textures, or .glb): triangles, transformations, base colours and
/// emission. Up is y. The files that it names must lie in the folder `confine`, if there is one.
/// \throws InputError naming the file.
Scene read_gltf(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

}  // namespace patchlight
