#include "cli/sensors.h"

#include "patchlight/base/error.h"
#include "patchlight/gather/gather.h"
#include "patchlight/input/read_points.h"
#include "patchlight/lighting/direct_irradiance.h"

#include "cli/text_table.h"
#include "effects.h"

#include <numbers>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

// The horizontal irradiance outside of a CIE overcast sky, when that is all the light there is: then readings have a
// daylight factor.
std::optional<Spectrum> only_overcast_sky(const Scene& scene) {
  if (!scene.sky || scene.sky->kind != SkyKind::cie_overcast || scene.sun || !scene.luminaires.empty()) return {};
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_lamp(scene, p)) return {};
  }
  const Sky& sky = *scene.sky;
  if (sky.horizontal_irradiance.size() > 0) return sky.horizontal_irradiance;
  return 7.0 / 9 * std::numbers::pi * sky.zenith_radiance;  // E = 7 pi L_z / 9: Moon and Spencer 1942
}

}  // namespace

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

Readings read_sensors(const Scene& whole, const Simulation& simulation, const Observer& observer) {
  const Scene scene = scene_for_sensors(whole, simulation.plan);
  // Without interreflection sensors see what lamps send, and nothing that is reflected.
  const Field& sent =
      simulates(simulation.plan, Effect::interreflection) ? simulation.solution.radiosity : simulation.problem.exitance;
  const std::vector<Sensor> sensors = all_sensors(scene.sensors);
  const std::uint64_t seed = simulation.plan.seed;
  const Coverings coverings = find_coverings(scene, simulation.plan.sides);
  const Occluder occluder(scene, Occluder::Blockers::all, coverings);
  GatheredIrradiance gathered = gather_irradiance(simulation.mesh, sent, occluder, sensors, {.seed = seed}, observer);
  Readings readings = {.irradiance = std::move(gathered.irradiance),
                       .standard_error = std::move(gathered.standard_error),
                       .photometric = scene.photometric,
                       .outside_by_sky = only_overcast_sky(scene)};
  if (!has_point_or_daylight(scene)) return readings;
  std::vector<SurfacePoint> points;
  for (const Sensor& sensor : sensors) points.push_back({sensor.point, sensor.normal});
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, coverings), points, {.seed = seed}, observer);
  readings.irradiance += direct.irradiance;
  readings.standard_error = (readings.standard_error.square() + direct.standard_error.square()).sqrt();
  return readings;
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
