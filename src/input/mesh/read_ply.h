#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads a PLY file (ASCII or binary): its faces. PLY has no materials that mean reflectance: all faces get "default".
/// \throws InputError naming the file.
Scene read_ply(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
