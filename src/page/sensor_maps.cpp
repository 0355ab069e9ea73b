#include "page/sensor_maps.h"

#include "page/packed.h"

#include <vector>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;

void append_place(std::vector<float>& numbers, const Point& place) {
  for (const double coordinate : place) numbers.push_back(static_cast<float>(coordinate));
}

Json cells_of_grid(const SensorGroup& group) {
  std::vector<float> corners;
  for (const auto& cell : group.cells) {
    for (const Point& corner : cell) append_place(corners, corner);
  }
  return packed_array<float>(corners, 12);
}

Json sensor_map(const SensorGroup& group, const Readings& readings, std::size_t first) {
  std::vector<float> places, normals, values, errors, factors;
  for (std::size_t k = 0; k < group.sensors.size(); ++k) {
    const SensorValue value = sensor_value(readings, first + k);
    append_place(places, group.sensors[k].point);
    append_place(normals, group.sensors[k].normal);
    values.push_back(static_cast<float>(value.value));
    errors.push_back(static_cast<float>(value.standard_error));
    if (readings.outside_by_sky) factors.push_back(static_cast<float>(daylight_factor(readings, first + k)));
  }
  Json part{{"name", group.name}, {"unit", sensor_unit(readings)}};
  part["places"] = packed_array<float>(places, 3);
  part["normals"] = packed_array<float>(normals, 3);
  part["values"] = packed_array<float>(values, 1);
  part["standard_errors"] = packed_array<float>(errors, 1);
  if (readings.outside_by_sky) part["daylight_factors"] = packed_array<float>(factors, 1);
  if (!group.cells.empty()) part["cells"] = cells_of_grid(group);
  return part;
}

}  // namespace

Json sensor_maps(std::span<const SensorGroup> groups, const Readings& readings) {
  Json maps = Json::array();
  std::size_t first = 0;
  for (const SensorGroup& group : groups) {
    maps.push_back(sensor_map(group, readings, first));
    first += group.sensors.size();
  }
  return maps;
}

}  // namespace patchlight
