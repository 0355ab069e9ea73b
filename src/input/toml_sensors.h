#pragma once

#include "input/toml_models.h"

#include <filesystem>
#include <variant>
#include <vector>

namespace patchlight {

/// The tables [[sensors]]; files of points are read. \throws InputError.
std::vector<std::variant<SensorGroup, FloorGrid>> sensors_of(const TomlValue& root, const TomlFrame& frame);

/// The files of points that a scene file names.
std::vector<std::filesystem::path> sensor_files(const TomlValue& root, const TomlFrame& frame);

/// Grids over floors.
struct FloorSensors {
  std::vector<SensorGroup> groups;
  std::string note;  ///< on rooms too narrow for one; empty if none is
};

/// The grid over the floor of the groups that it names, or one over that of each of the rooms. \throws InputError when
/// there are no such groups or rooms, or no floor.
FloorSensors sensors_over(const Scene& scene, const FloorGrid& grid);

}  // namespace patchlight
