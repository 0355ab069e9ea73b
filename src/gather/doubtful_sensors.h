#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "gather/sensor_places.h"

#include <span>

namespace patchlight {

/// A sentence for each sensor that does not stand free, with its file and line; at most five, and then one
/// that counts the rest. `places` as place_sensors() gives them.
Diagnostics doubtful_sensors(const std::vector<SensorGroup>& sensors, std::span<const SensorPlace> places);

/// A sentence where sensors lie farther from the scene's bounds than these are long, as points in another unit do.
Diagnostics sensors_far_off(const Scene& scene, const std::vector<SensorGroup>& sensors);

/// A sentence where sensors look at patches with pictures from nearer than one and a half times these are wide: each
/// patch sends them the mean of its part of the picture, and no error bar holds what the texels differ. Empty without
/// such sensors. O(sensors x patches with pictures).
Diagnostics sensors_close_to_pictures(const Scene& scene, const std::vector<SensorGroup>& sensors,
                                      const PatchMesh& mesh);

}  // namespace patchlight
