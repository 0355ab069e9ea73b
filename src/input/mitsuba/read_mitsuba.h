#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads a Mitsuba scene (XML, 0.5 to 3) and the files and meshes that it names, which must lie in the folder `confine`
/// if there is one. Fills Scene::vertices (metres), polygons, materials, groups, luminaires, sun, sky, cameras, file,
/// inputs, sha256, metres_per_unit and notes. \throws InputError naming the file and the line.
Scene read_mitsuba(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

}  // namespace patchlight
