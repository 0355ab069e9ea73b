#pragma once

#include "patchlight/scene/sensor.h"

#include <filesystem>
#include <string_view>

namespace patchlight {

/// Reads lines `x y z nx ny nz` separated by spaces, tabs or commas, as for Radiance's rtrace: a position in units of
/// `metres_per_unit` and a direction of any length. Empty lines and what follows a # are skipped. The group is named
/// after the file, which may be a pipe. \throws InputError naming the file and line.
SensorGroup read_points(const std::filesystem::path& file, double metres_per_unit);

/// The same from a text; `file` gives the group its name.
SensorGroup parse_points(std::string_view text, const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight
