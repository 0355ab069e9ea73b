#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads an OBJ file and the MTL files it names, which must lie in the folder `confine` if there is one. Fills
/// Scene::vertices (metres), polygons, materials (those that faces use), groups, file, sha256, metres_per_unit and
/// notes. \throws InputError naming the file and the line.
Scene read_obj(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

}  // namespace patchlight
