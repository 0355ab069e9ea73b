#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/scene/sensor.h"

#include <nlohmann/json.hpp>
#include <span>

namespace patchlight {

/// Per group of sensors its name, unit, places, values, standard errors, daylight factors where there are any, and of a
/// grid the cells.
nlohmann::ordered_json sensor_maps(std::span<const SensorGroup> groups, const Readings& readings);

}  // namespace patchlight
