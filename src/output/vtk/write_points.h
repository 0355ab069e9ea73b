#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/scene/sensor.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The extensions that write_points() knows, with their dots.
std::vector<std::string> points_extensions();

/// Writes what sensors read, by the extension of the file. .csv: a header line and a line for each sensor: x, y, z, nx,
/// ny, nz as they were given (in metres where there is no such text), irradiance, its standard error and that one's
/// parts per band in W/m^2 (E_r, E_g, E_b for three bands), with photometric lights illuminance and its standard error
/// in lx, under an overcast sky the daylight factor in percent, 1 inside a wall (where values are nan) and else 0, and
/// the group. .vtp: the same for ParaView, cells of grids as polygons, other sensors as vertices. \throws OutputError.
void write_points(const std::filesystem::path& file, std::span<const SensorGroup> groups, const Readings& readings);

}  // namespace patchlight
