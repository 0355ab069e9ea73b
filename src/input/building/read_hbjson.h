#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads a honeybee model (HBJSON): rooms with their faces, apertures, doors and shades, orphaned ones too, with the
/// modifiers of faces and of modifier sets, else honeybee's generic ones by the kind of face; rooms, sensor grids and
/// views. Faces that two rooms share are there twice, openings between them once; air boundaries are holes. The unit is
/// the file's, `metres_per_unit` a further factor. \throws InputError naming the file.
Scene read_hbjson(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
