#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads a COLLADA file: faces, transformations, diffuse and emissive colours, pictures of diffuse ones that lie in the
/// folder `confine`, if there is one, its unit and upright axis. \throws InputError naming the file.
Scene read_collada(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

}  // namespace patchlight
