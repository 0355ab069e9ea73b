#pragma once

#include "patchlight/base/geometry.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// A point at which irradiance is computed: meters, unit normal of the receiving side.
struct Sensor {
  Point point;
  Vector normal;
};

/// A named group of sensors.
struct SensorGroup {
  std::string name;
  std::vector<Sensor> sensors;
  std::vector<std::array<Point, 4>> cells = {};  ///< of a grid, one around each sensor, meters; else empty
  std::vector<std::string> columns = {};         ///< "x,y,z,nx,ny,nz" of each, as text of the file; else empty
  std::string file = {};                         ///< the file that defines them, for messages
  std::vector<std::uint32_t> lines = {};         ///< in it, one for each sensor; one for all when it is a grid
};

/// "sensor 3 of 'desk' (room.toml:12)", counted from 1, for messages.
std::string place_of(const SensorGroup& group, std::size_t sensor);

/// All sensors, group after group.
std::vector<Sensor> all_sensors(const std::vector<SensorGroup>& groups);

}  // namespace patchlight
