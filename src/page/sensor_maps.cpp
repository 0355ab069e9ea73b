#include "page/sensor_maps.h"

#include "output/plot/map_axes.h"
#include "output/report/json_array.h"
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

Json sensor_map(const Scene& scene, const SensorGroup& group, const Readings& readings, std::size_t first) {
  std::vector<float> places, values, errors, factors;
  for (std::size_t k = 0; k < group.sensors.size(); ++k) {
    const SensorValue value = sensor_value(readings, first + k);
    append_place(places, group.sensors[k].point);
    values.push_back(static_cast<float>(value.value));
    errors.push_back(static_cast<float>(value.standard_error));
    if (readings.outside_by_sky) factors.push_back(static_cast<float>(daylight_factor(readings, first + k)));
  }
  Json part{{"name", group.name}, {"unit", sensor_unit(readings)}};
  const MapAxes axes = map_axes(group.sensors[0].normal, scene.up, scene.north);
  part["right"] = json_array(axes.right);
  part["above"] = json_array(axes.above);
  part["places"] = packed_array<float>(places, 3);
  part["values"] = packed_array<float>(values, 1);
  part["standard_errors"] = packed_array<float>(errors, 1);
  if (readings.outside_by_sky) part["daylight_factors"] = packed_array<float>(factors, 1);
  if (!group.cells.empty()) part["cells"] = cells_of_grid(group);
  return part;
}

}  // namespace

Json sensor_maps(const Scene& scene, const Readings& readings) {
  Json maps = Json::array();
  std::size_t first = 0;
  for (const SensorGroup& group : scene.sensors) {
    if (group.sensors.empty()) continue;
    maps.push_back(sensor_map(scene, group, readings, first));
    first += group.sensors.size();
  }
  return maps;
}

}  // namespace patchlight
