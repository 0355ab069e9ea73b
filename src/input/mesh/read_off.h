#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads an OFF file: its faces. OFF has no materials: all faces get "default".
/// \throws InputError naming the file.
Scene read_off(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
