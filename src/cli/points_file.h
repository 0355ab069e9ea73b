#pragma once

#include "patchlight/gather/gather.h"

#include <filesystem>
#include <string>
#include <vector>

namespace patchlight::cli {

/// The points of a points file.
struct SensorList {
  std::vector<Sensor> sensors;     ///< metres
  std::vector<std::string> lines;  ///< the six numbers of each as the file has them, separated by commas
};

/// Reads lines `x y z nx ny nz` separated by spaces, tabs or commas: a position in model units and a direction of any
/// length. Empty lines and what follows a # are skipped. \throws InputError naming the file and line.
SensorList read_points(const std::filesystem::path& file, double metres_per_unit);

}  // namespace patchlight::cli
