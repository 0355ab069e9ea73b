#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <string_view>

namespace patchlight {

/// Reads a COLLADA file: faces, transformations, diffuse and emissive colours, pictures of diffuse ones that lie in the
/// folder `confine`, if there is one, its unit and upright axis. \throws InputError naming the file.
Scene read_collada(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// Metres per unit of a COLLADA text: the attribute meter of its first <unit>; 1 without one.
double collada_unit(std::string_view text);

}  // namespace patchlight
