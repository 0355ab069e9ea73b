#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads an STL file (ASCII or binary): its triangles. STL has no materials: all faces get "default".
/// \throws InputError naming the file.
Scene read_stl(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
