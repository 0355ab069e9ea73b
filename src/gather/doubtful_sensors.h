#pragma once

#include "patchlight/scene/scene.h"

#include "gather/sensor_places.h"

#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// A sentence for each sensor of the scene that does not stand free, with its file and line; at most five, and then one
/// that counts the rest. `places` as place_sensors() gives them.
std::vector<std::string> doubtful_sensors(const Scene& scene, std::span<const SensorPlace> places);

}  // namespace patchlight
