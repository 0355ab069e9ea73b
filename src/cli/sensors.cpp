#include "cli/sensors.h"

#include "patchlight/base/error.h"
#include "patchlight/gather/gather.h"
#include "patchlight/input/read_points.h"

#include "cli/text_table.h"

#include <utility>
#include <vector>

namespace patchlight::cli {

Scene with_points(Scene scene, const SolveArguments& arguments) {
  if (arguments.points.empty()) return scene;
  scene.sensors.push_back(read_points(arguments.points, scene.metres_per_unit));
  return scene;
}

std::vector<std::filesystem::path> points_outputs(const SolveArguments& arguments, const Scene& scene) {
  if (!scene.sensors.empty()) {
    if (!arguments.points_outputs.empty()) return arguments.points_outputs;
    return {arguments.default_points_output};
  }
  if (arguments.points_outputs.empty()) return {};
  throw InputError("--points-output", "the scene file has no sensors; give it a table [[sensors]], or --points FILE");
}

Readings read_sensors(const Scene& scene, const Simulation& simulation, const Occluder& occluder,
                      const Observer& observer) {
  GatheredIrradiance gathered =
      gather_irradiance(simulation.mesh, simulation.solution.radiosity, simulation.problem.exitance, occluder,
                        all_sensors(scene.sensors), {.seed = simulation.plan.seed}, observer);
  return {.irradiance = std::move(gathered.irradiance),
          .standard_error = std::move(gathered.standard_error),
          .photometric = scene.photometric};
}

std::string sensor_summary(const Scene& scene, const Readings& readings) {
  if (scene.sensors.empty()) return {};
  const std::string in_unit = std::string(", ") + sensor_unit(readings);
  std::vector<TextRow> rows = {{"sensors", "number", "min" + in_unit, "mean" + in_unit, "max" + in_unit, "U0",
                                "largest standard error" + in_unit}};
  if (readings.outside_by_sky) rows[0].emplace_back("mean daylight factor, %");
  for (const GroupReadings& group : by_group(scene.sensors, readings)) {
    rows.push_back({group.name, std::to_string(group.sensors), rounded(group.min), rounded(group.mean),
                    rounded(group.max), rounded(group.uniformity), rounded(group.largest_standard_error, 2)});
    if (group.mean_daylight_factor) rows.back().push_back(rounded(*group.mean_daylight_factor));
  }
  return text_table(rows);
}

}  // namespace patchlight::cli
