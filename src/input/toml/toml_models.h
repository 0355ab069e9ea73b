#pragma once

#include "input/toml/scene_file.h"
#include "input/toml/toml_value.h"

#include <filesystem>
#include <vector>

namespace patchlight {

/// What the tables [[model]] of a scene file stand in.
struct TomlFrame {
  std::filesystem::path file;          ///< the scene file
  std::filesystem::path confine = {};  ///< the folder in which the files that it names must lie; empty for any
  double metres_per_unit = 1;          ///< of its lengths
  Vector up = Vector::UnitZ();         ///< of the scene
};

/// The value as a path; relative ones start from the folder of the scene file. \throws InputError when it does not lie
/// in the folder that the frame allows.
std::filesystem::path named_file(const TomlValue& value, const TomlFrame& frame);

/// The tables [[model]]. \throws InputError.
std::vector<ModelEntry> models_of(const TomlValue& root, const TomlFrame& frame);

/// The tables [[material]]; the spectra that they name are read. \throws InputError.
std::vector<MaterialSetting> settings_of(const TomlValue& root, const TomlFrame& frame);

}  // namespace patchlight
