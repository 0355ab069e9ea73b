#pragma once

#include "patchlight/gather/readings.h"
#include "patchlight/scene/scene.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// Per group of sensors its name, unit, the axes of its map (map_axes()), places, values, standard errors, daylight
/// factors where there are any, and of a grid the cells.
nlohmann::ordered_json sensor_maps(const Scene& scene, const Readings& readings);

}  // namespace patchlight
