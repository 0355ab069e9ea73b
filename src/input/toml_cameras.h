#pragma once

#include "patchlight/scene/scene.h"

#include "input/toml_models.h"
#include "input/toml_value.h"

#include <vector>

namespace patchlight {

/// The cameras [[camera]] of a scene file, in metres. \throws InputError.
std::vector<Camera> cameras_of(const TomlValue& root, const TomlFrame& frame);

}  // namespace patchlight
