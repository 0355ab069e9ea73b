#include "output/sensors_part.h"

namespace patchlight {

nlohmann::ordered_json sensors_part(const SensorFacts& sensors) {
  using Json = nlohmann::ordered_json;
  Json part;
  part["unit"] = sensors.unit;
  part["groups"] = Json::array();
  for (const GroupReadings& group : sensors.groups) {
    Json entry;
    entry["name"] = group.name;
    entry["sensors"] = group.sensors;
    entry["inside_walls"] = group.inside_walls;
    entry["min"] = group.min;
    entry["mean"] = group.mean;
    entry["standard_error_of_mean"] = group.standard_error_of_mean;
    entry["max"] = group.max;
    entry["uniformity"] = group.uniformity;
    entry["largest_standard_error"] = group.largest_standard_error;
    if (group.mean_daylight_factor) entry["mean_daylight_factor_percent"] = *group.mean_daylight_factor;
    part["groups"].push_back(std::move(entry));
  }
  part["warnings"] = sensors.warnings;
  return part;
}

}  // namespace patchlight
