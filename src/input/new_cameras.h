#pragma once

#include "patchlight/scene/scene.h"

#include "scene/sensor_grid.h"

#include <string>
#include <vector>

namespace patchlight {

/// Where sensors and cameras of a new scene file belong.
struct NamedFloor {
  std::string name;
  Floor floor;
  double window_area = 0;  ///< of the room, m^2; 0 where it has no windows, or is not known as a room
};

/// The tables of cameras of a new scene file: in three places at most, those with the largest windows first and, of
/// equal ones, as in dark rooms, in the order given. From one end of the floor to the other, towards the glass. Nothing
/// for a scene that names no rooms or has views of its own.
std::string camera_tables(const Scene& scene, const std::vector<NamedFloor>& places);

}  // namespace patchlight
