#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads an IFC file: the geometry of its objects in metres, and their colours as reflectances. Up is z.
/// \throws InputError naming the file.
Scene read_ifc(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
