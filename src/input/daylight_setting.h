#pragma once

#include "patchlight/input/read_scene.h"

#include "input/scene_lights.h"

#include <filesystem>

namespace patchlight {

/// True when a sky, a sun or a weather file is asked for.
bool asks_for_daylight(const DaylightSetting& setting);

/// Sun and sky of a setting. The weather file must lie in the folder `confine`, if there is one. \throws InputError
/// naming a field of read.daylight, or the file and line.
LightEntries lights_of(const DaylightSetting& setting, const std::filesystem::path& confine);

}  // namespace patchlight
