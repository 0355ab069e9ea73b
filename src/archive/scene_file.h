#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <filesystem>

namespace patchlight {

/// The scene of stored form factors, and its simulated sides.
struct StoredScene {
  Scene scene;  ///< its diagnostics without their faces
  KeptSides sides;
};

/// Writes scene.json of a folder of form factors. Every number is read again as it was, and so is every name, whatever
/// its bytes. docs/reference/outputs/form-factor-folder.md describes the file. \throws OutputError.
void write_stored_scene(const std::filesystem::path& file, const Scene& scene, const KeptSides& sides);

/// Reads scene.json of such a folder. \throws InputError when there is none, or when it is damaged.
StoredScene read_stored_scene(const std::filesystem::path& folder);

}  // namespace patchlight
