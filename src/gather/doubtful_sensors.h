#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "gather/sensor_places.h"

#include <span>

namespace patchlight {

/// Messages for sensors that do not stand free, with file and line: at most five, then one with the number of the rest.
/// `places` comes from place_sensors().
Diagnostics doubtful_sensors(const std::vector<SensorGroup>& sensors, std::span<const SensorPlace> places);

/// A message if sensors lie farther from the scene's bounds than the size of the bounds, e.g. points in another unit.
Diagnostics sensors_far_off(const Scene& scene, const std::vector<SensorGroup>& sensors);

/// A message if sensors look at textured patches from less than 1.5 times their width. Each patch sends them the mean
/// of its part of the texture, and error bars do not include the differences between texels. Empty without such
/// sensors. O(sensors x textured patches).
Diagnostics sensors_close_to_pictures(const Scene& scene, const std::vector<SensorGroup>& sensors,
                                      const PatchMesh& mesh);

}  // namespace patchlight
