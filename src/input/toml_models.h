#pragma once

#include "input/scene_file.h"
#include "input/toml_value.h"

#include <filesystem>
#include <vector>

namespace patchlight {

/// What the tables [[model]] of a scene file stand in.
struct TomlFrame {
  std::filesystem::path file;   ///< the scene file
  double metres_per_unit = 1;   ///< of its lengths
  Vector up = Vector::UnitZ();  ///< of the scene
};

/// The tables [[model]]. \throws InputError.
std::vector<ModelEntry> models_of(const TomlValue& root, const TomlFrame& frame);

/// The tables [[material]]. \throws InputError.
std::vector<MaterialSetting> settings_of(const TomlValue& root);

}  // namespace patchlight
