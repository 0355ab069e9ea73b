#pragma once

#include "input/scene_lights.h"
#include "input/toml/toml_models.h"

#include <filesystem>
#include <vector>

namespace patchlight {

/// The tables [[luminaire]], one entry for each position; photometric files are read. \throws InputError.
std::vector<LuminaireEntry> luminaires_of(const TomlValue& root, const TomlFrame& frame);

/// True when some luminaire is stated in lumens, or by a photometric file.
bool in_lumens(const TomlValue& root);

/// All lights of a scene file: luminaires, north, [site], [sun], [sky], [weather] and [ground]. \throws InputError.
LightEntries lights_of(const TomlValue& root, const TomlFrame& frame);

/// The photometric and weather files that a scene file names.
std::vector<std::filesystem::path> light_files(const TomlValue& root, const TomlFrame& frame);

}  // namespace patchlight
