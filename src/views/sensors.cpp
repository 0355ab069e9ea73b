#include "patchlight/gather/gather.h"
#include "patchlight/views/views.h"

#include "gather/doubtful_sensors.h"
#include "gather/sensor_places.h"
#include "lighting/direct_irradiance.h"
#include "lighting/light_paths.h"
#include "lighting/mirror_paths.h"
#include "pipeline/exchange_and_light.h"
#include "pipeline/radiosity_errors.h"
#include "pipeline/world.h"
#include "plan/planned_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace patchlight {
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

// The sensors that are not inside walls.
std::vector<Sensor> free_sensors(std::span<const SensorPlace> places) {
  std::vector<Sensor> sensors;
  for (const SensorPlace& place : places) {
    if (place.standing != Standing::inside_wall) sensors.push_back(place.sensor);
  }
  return sensors;
}

// A row for each place from one for each of the free sensors; NaN inside walls.
Field at_places(const Field& values, std::span<const SensorPlace> places) {
  Field all(static_cast<Eigen::Index>(places.size()), values.cols());
  Eigen::Index next = 0;
  for (Eigen::Index row = 0; row < all.rows(); ++row) {
    if (places[static_cast<std::size_t>(row)].standing == Standing::inside_wall)
      all.row(row).setConstant(std::numeric_limits<double>::quiet_NaN());
    else
      all.row(row) = values.row(next++);
  }
  return all;
}

std::vector<SurfacePoint> points_of(const std::vector<Sensor>& sensors) {
  std::vector<SurfacePoint> points;
  for (const Sensor& sensor : sensors) points.push_back({sensor.point, sensor.normal});
  return points;
}

// The lamps whose mirrored light is computed over chains of mirrors.
std::vector<EmitterSide> emitters_in_mirrors(const Simulation& simulation) {
  const World& world = *simulation.world;
  if (!world.sensor_lighting().mirrors) return {};
  return select_emitters(world.sensor_scene(), simulation.mesh, simulation.problem,
                         max_emitter_pieces(world.tracing()));
}

Field without_exitance(Field sent, const Simulation& simulation, std::span<const EmitterSide> lamps) {
  for (const auto& [polygon, side] : lamps) {
    const auto [begin, end] = simulation.mesh.patches_on(polygon, side);
    sent.middleRows(begin, end - begin) -= simulation.problem.exitance.middleRows(begin, end - begin);
  }
  return sent;
}

std::vector<EmitterFace> faces_of(const Scene& scene, std::span<const EmitterSide> lamps) {
  std::vector<EmitterFace> all;
  for (const auto& [polygon, side] : lamps) {
    const auto faces = emitter_faces(scene, polygon, side);
    all.insert(all.end(), faces.begin(), faces.end());
  }
  return all;
}

// The irradiance by patches, luminaires, sun and sky, directly and in mirrors.
GatheredIrradiance irradiance_at(const std::vector<Sensor>& sensors, const Simulation& simulation,
                                 const Observer& observer) {
  const World& world = *simulation.world;
  // Without interreflection sensors see the light of lamps alone.
  const Field& sent =
      simulates(simulation.plan, Effect::interreflection) ? simulation.solution.radiosity : simulation.problem.exitance;
  const std::uint64_t seed = simulation.plan.assembly.seed;
  const Lighting& lighting = world.sensor_lighting();
  const std::vector<EmitterSide> lamps = emitters_in_mirrors(simulation);
  const Field mirrored = without_exitance(sent, simulation, lamps);
  OtherIrradiance direct;
  const bool has_direct = has_point_or_daylight(world.sensor_scene()) || lighting.mirrors;
  if (has_direct) {
    DirectIrradiance found = direct_irradiance({lighting, faces_of(world.sensor_scene(), lamps)}, points_of(sensors),
                                               {.seed = seed}, observer);
    direct = {std::move(found.irradiance), std::move(found.standard_error)};
  }
  GatheredIrradiance gathered = gather_irradiance(simulation.mesh, sent, world.all_faces(), sensors,
                                                  {.seed = seed,
                                                   .errors = radiosity_errors(simulation),
                                                   .paths = &lighting.paths,
                                                   .aim = lighting.mirrors ? &lighting.mirrors->aim : nullptr,
                                                   .mirrored_light = &mirrored,
                                                   .other = has_direct ? &direct : nullptr},
                                                  observer);
  // Light that is still under way, by how much is not known.
  const bool is_known = simulation.solution.converged || simulation.solution.error.size() > 0;
  if (!is_known) gathered.errors.solver.setConstant(std::nan(""));
  if (has_direct) {
    gathered.irradiance += direct.mean;
    gathered.errors.rays = (gathered.errors.rays.square() + direct.standard_error.square()).sqrt();
  }
  return gathered;
}

Readings readings_at(std::span<const SensorPlace> places, const Simulation& simulation, const Observer& observer) {
  const Scene& scene = simulation.world->sensor_scene();
  const auto [irradiance, errors] = irradiance_at(free_sensors(places), simulation, observer);
  Readings readings = {.irradiance = at_places(irradiance, places),
                       .standard_error = at_places(errors.total(), places),
                       .errors = {.rays = at_places(errors.rays, places),
                                  .sampling = at_places(errors.sampling, places),
                                  .mesh = at_places(errors.mesh, places),
                                  .solver = at_places(errors.solver, places)},
                       .bands = bands_of(scene),
                       .photometric = scene.photometric,
                       .outside_by_sky = only_overcast_sky(scene)};
  for (const SensorPlace& place : places) readings.inside_wall.push_back(place.standing == Standing::inside_wall);
  return readings;
}

}  // namespace

bool has_daylight_factors(const Scene& scene) { return only_overcast_sky(scene).has_value(); }

SensorView read_sensors(const Simulation& simulation, const Observer& observer) {
  return read_sensors(simulation, simulation.world->scene().sensors, observer);
}

SensorView read_sensors(const Simulation& simulation, const std::vector<SensorGroup>& sensors,
                        const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  const std::vector<SensorPlace> places =
      place_sensors(scene, sensors, simulation.plan.sides, simulation.world->all_faces());
  return {readings_at(places, simulation, observer),
          merged({doubtful_sensors(sensors, places), sensors_far_off(scene, sensors),
                  sensors_close_to_pictures(scene, sensors, simulation.mesh)})};
}

}  // namespace patchlight
