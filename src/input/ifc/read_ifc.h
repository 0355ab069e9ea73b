#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <optional>

namespace patchlight {

/// Reads an IFC file: the geometry of its objects in metres, and their colors as reflectances. Up is z.
/// `metres_per_unit` replaces the unit that the file states. \throws InputError naming the file.
Scene read_ifc(const std::filesystem::path& file, std::optional<double> metres_per_unit);

}  // namespace patchlight
