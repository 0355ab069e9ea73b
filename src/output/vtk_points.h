#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/scene/sensor.h"

#include <filesystem>
#include <span>

namespace patchlight {

/// What sensors read as VTK XML PolyData. Cell arrays: irradiance, irradiance_standard_error, illuminance or
/// weighted_irradiance with its standard error, daylight_factor where there is one, normal, group (its number),
/// sensor (its row in the table) and inside_wall (1 or 0; the values there are NaN). FieldData: group_names, units.
/// Cells come in VTK's order: vertices first, then polygons. \throws OutputError.
void write_points_for_paraview(const std::filesystem::path& file, std::span<const SensorGroup> groups,
                               const Readings& readings);

}  // namespace patchlight
