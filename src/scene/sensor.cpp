#include "patchlight/scene/sensor.h"

#include <algorithm>

namespace patchlight {

std::string place_of(const SensorGroup& group, std::size_t sensor) {
  std::string place = "sensor " + std::to_string(sensor + 1) + " of '" + group.name + "'";
  if (group.lines.empty()) return place;
  return place + " (" + group.file + ":" + std::to_string(group.lines[std::min(sensor, group.lines.size() - 1)]) + ")";
}

std::vector<Sensor> all_sensors(const std::vector<SensorGroup>& groups) {
  std::vector<Sensor> all;
  for (const SensorGroup& group : groups) all.insert(all.end(), group.sensors.begin(), group.sensors.end());
  return all;
}

}  // namespace patchlight
