#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "visibility/occluder.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// The meaning of a sensor's place for its reading.
enum class Standing : std::uint8_t {
  free,         ///< it reads the light that reaches the place
  inside_wall,  ///< the place is inside a solid: there is nothing to read
  undecided     ///< it lies in a surface that it does not face along: rounding decides on which side
};

/// Where a sensor is read.
struct SensorPlace {
  Sensor sensor;
  Standing standing = Standing::free;
};

/// Those of all sensors, group after group. A sensor nearer to a polygon than 1e-5 of the polygon's size (or
/// 1e-6 of the scene's) lies on it: it is read just before the side to which it faces, whichever side rounding has left
/// it on, and at that distance if it does not face along the normal. A sensor is inside a wall in two cases. All of 64
/// rays in all directions meet sides that are not simulated, by `sides` or by Sides::automatic. Or each of them meets
/// such a side, or from behind the polygons of one shell that is open only where it stands on other polygons, or these
/// polygons; and neither the sensor nor the places met see a lamp. The occluder must be one of all polygons.
/// O(sensors x polygons).
std::vector<SensorPlace> place_sensors(const Scene& scene, const std::vector<SensorGroup>& groups,
                                       const KeptSides& sides, const Occluder& occluder);

}  // namespace patchlight
