// How many sensors lie within 2.6 of their stated errors, against paths: what normal errors do for 99 %.
// usage: benchmark_sensor_coverage PERCENT PATHS MODEL...
// Each model is solved to an accuracy of so many percent. PATHS per sensor: 16384 know it to about a percent.
#include "patchlight/gather/gather.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"

#include "gather/sensor_places.h"
#include "pipeline/radiosity_errors.h"
#include "scene/repair.h"
#include "verify/path_tracer.h"
#include "visibility/occluder.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace {

using namespace patchlight;

// The third axis is up.
constexpr int up = 2;

// Grids of 7 x 7 sensors that face up, at a third of the scene's height and 1 mm above the floor.
std::vector<Sensor> grids(const Scene& scene) {
  const Box box = bounds(scene);
  std::vector<Sensor> sensors;
  for (const double height : {1.0 / 3, 0.001 / box.diagonal()[up]}) {
    for (int k = 0; k < 49; ++k) {
      Vector share = Vector::Constant(height);
      share[(up + 1) % 3] = (k % 7 + 0.5) / 7;
      share[(up + 2) % 3] = (k / 7 + 0.5) / 7;
      sensors.push_back({.point = box.min() + share.cwiseProduct(box.diagonal()), .normal = Vector::Unit(up)});
    }
  }
  return sensors;
}

// Those that do not stand inside something.
std::vector<Sensor> sensors_in(Scene scene, const KeptSides& sides) {
  const std::vector<Sensor> grid = grids(scene);
  scene.sensors = {{.name = "grid", .sensors = grid}};
  const Occluder occluder(scene, Occluder::Blockers::all);
  std::vector<Sensor> sensors;
  for (const SensorPlace& place : place_sensors(scene, sides, occluder)) {
    if (place.standing == Standing::free) sensors.push_back(place.sensor);
  }
  return sensors;
}

// By paths from black squares at the sensors, of a ten-thousandth of the scene's extent, which take no other light
// away.
PathEstimate traced(Scene scene, KeptSides sides, const std::vector<Sensor>& sensors, std::uint32_t paths) {
  const double half = 5e-5 * bounds(scene).diagonal().norm();
  const auto black = static_cast<MaterialIndex>(scene.materials.size());
  scene.materials.push_back({.name = "sensor",
                             .reflectance = Spectrum::Zero(scene.materials[0].reflectance.size()),
                             .exitance = Spectrum::Zero(scene.materials[0].exitance.size())});
  std::vector<PathReceiver> receivers;
  for (const Sensor& sensor : sensors) {
    const Point& p = sensor.point;
    const Vector x = half * Vector::UnitX(), y = half * Vector::UnitY();
    const std::array<Point, 4> corners{p - x - y, p + x - y, p + x + y, p - x + y};
    receivers.push_back({corners, static_cast<PolygonIndex>(scene.polygons.size()), Side::front});
    Polygon square{.corners = {}, .material = black};
    for (const Point& corner : corners) {
      square.corners.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
      scene.vertices.push_back(corner);
    }
    scene.polygons.push_back(square);
    sides.front.push_back(1);
    sides.back.push_back(1);
  }
  return trace_irradiance(scene, sides, receivers, {.paths = paths});
}

struct Count {
  int sensors = 0;
  int values = 0;
  int within = 0;
};

Count judged(const char* model, double accuracy, std::uint32_t paths) {
  const Scene scene = repair(read_scene(model));
  Request request;
  request.mesh.sides = Sides::front;
  request.accuracy.relative_error = accuracy;
  const Simulation simulation = simulate(scene, request);
  const std::vector<Sensor> sensors = sensors_in(scene, simulation.plan.sides);
  const Occluder occluder(scene, Occluder::Blockers::all, find_coverings(scene, simulation.plan.sides));
  const GatheredIrradiance found = gather_irradiance(simulation.mesh, simulation.solution.radiosity, occluder, sensors,
                                                     {.errors = radiosity_errors(simulation)});
  const PathEstimate reference = traced(scene, simulation.plan.sides, sensors, paths);
  const Field stated = found.errors.total();
  const Field difference = found.irradiance - reference.irradiance;
  const Field allowed = 2.6 * (stated.square() + reference.standard_error.square()).sqrt();
  const Count count{static_cast<int>(sensors.size()), static_cast<int>(difference.size()),
                    static_cast<int>((difference.abs() <= allowed).count())};
  std::printf("| %s | %u | %d | %.1f %% | %.2f %% | %.2f %% | %.2f %% |\n", std::filesystem::path(model).stem().c_str(),
              simulation.mesh.size(), count.sensors, 100.0 * count.within / count.values,
              100 * std::sqrt(difference.square().mean()) / reference.irradiance.mean(),
              100 * std::sqrt(stated.square().mean()) / reference.irradiance.mean(),
              100 * std::sqrt(reference.standard_error.square().mean()) / reference.irradiance.mean());
  std::fflush(stdout);
  return count;
}

}  // namespace

int main(int count, char** values) {
  if (count < 4) {
    std::fputs("usage: benchmark_sensor_coverage PERCENT PATHS MODEL...\n", stderr);
    return 1;
  }
  std::puts(
      "| scene | patches | sensors | within 2.6 | difference, rms | stated, rms | of paths, rms |\n"
      "|---|---|---|---|---|---|---|");
  Count all;
  for (int k = 3; k < count; ++k) {
    const Count one = judged(values[k], std::atof(values[1]) / 100, static_cast<std::uint32_t>(std::atoi(values[2])));
    all = {all.sensors + one.sensors, all.values + one.values, all.within + one.within};
  }
  std::printf("%d sensors, %.2f %% of the values within 2.6\n", all.sensors, 100.0 * all.within / all.values);
  return 0;
}
