#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"

#include <span>
#include <vector>

namespace patchlight {

/// The points from which sensors are read. A sensor lies on a polygon if it is nearer than 1e-5 of the polygon's size
/// or 1e-6 of the scene's. It is then moved just in front of the side that it faces along. O(sensors x corners).
std::vector<Point> points_before_polygons(const Scene& scene, std::span<const Sensor> sensors);

}  // namespace patchlight
