// The rooms of benchmark_random_rooms: the same bits for the same seed, watertight, and readable as scene files.
#include "support/random_rooms.h"

#include "patchlight/base/diagnostics.h"
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "pipeline/world.h"
#include "unit/output/temporary_folder.h"
#include "verify/path_tracer.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace patchlight {
namespace {

using namespace test;

std::vector<std::string> all_kinds() {
  std::vector<std::string> kinds = daylight_kinds();
  const std::vector<std::string> lamps = lamp_kinds();
  kinds.insert(kinds.end(), lamps.begin(), lamps.end());
  return kinds;
}

// All files of a room, concatenated.
std::string text_of(const RandomRoom& room, const std::filesystem::path& folder) {
  const std::filesystem::path scene_file = write_random_room(room, folder);
  std::string text;
  for (const char* extension : {".toml", ".obj", ".mtl", ".ies"})
    text += content_of(std::filesystem::path(scene_file).replace_extension(extension));
  return text;
}

TEST(RandomRooms, ASeedAlwaysMakesTheSameFiles) {
  const TemporaryFolder folder;
  for (const std::string& kind : all_kinds()) {
    const std::string text = text_of(make_random_room(kind, 3, 1), folder.path());
    EXPECT_EQ(text, text_of(make_random_room(kind, 3, 1), folder.path())) << kind;
    EXPECT_NE(text, text_of(make_random_room(kind, 3, 2), folder.path())) << kind;
    EXPECT_NE(text, text_of(make_random_room(kind, 4, 1), folder.path())) << kind;
  }
}

// The surface integrals of n and of x . n / 3 over the faces of one group.
struct Integrals {
  Vector area = Vector::Zero();
  double volume = 0;
  Box bounds;
};

Integrals integrate(const RandomRoom& room, const std::string& group) {
  Integrals sums;
  for (const RoomFace& face : room.faces) {
    if (face.group != group) continue;
    const Vector area = area_vector(face.corners);
    sums.area += area;
    sums.volume += area.dot(face.corners[0]) / 3;
    for (const Point& corner : face.corners) sums.bounds.extend(corner);
  }
  return sums;
}

// The area vectors of a closed surface sum to zero, and the divergence theorem gives its volume. Thick walls enclose a
// solid; walls without thickness enclose the air, together with the panes.
TEST(RandomRooms, WallsAndPanesAreClosed) {
  for (const std::string& kind : all_kinds())
    for (std::size_t number = 0; number < 8; ++number) {
      const RandomRoom room = make_random_room(kind, number, 1);
      const Integrals walls = integrate(room, "room"), panes = integrate(room, "pane");
      const double air = room.size.prod(), outside = walls.bounds.volume();
      const bool is_thick = outside > air * (1 + 1e-9);
      const double thickness = -walls.bounds.min().y();
      const double solid = outside - air - thickness * panes.area.norm();
      const Vector area = is_thick ? walls.area : Vector(walls.area + panes.area);
      EXPECT_LT(area.norm(), 1e-10 * air) << room.name;
      EXPECT_NEAR(is_thick ? walls.volume : -(walls.volume + panes.volume), is_thick ? solid : air, 1e-9 * air)
          << room.name;
    }
}

// With opaque panes no path from a sensor reaches the sky or the sun.
TEST(RandomRooms, NoDaylightLeaksIn) {
  const TemporaryFolder folder;
  for (const std::string& kind : daylight_kinds()) {
    RandomRoom room = make_random_room(kind, 1, 1);
    const auto trace = [&] {
      const Scene scene = read_scene(write_random_room(room, folder.path()));
      return trace_irradiance(scene, kept_sides(scene, Sides::both), all_sensors(scene.sensors), {.paths = 256});
    };
    EXPECT_TRUE((trace().irradiance > 0).all()) << kind;
    for (RoomMaterial& material : room.materials) material.transmittance = 0;
    EXPECT_TRUE((trace().irradiance == 0).all()) << kind;
  }
}

TEST(RandomRooms, FilesAreReadWithoutErrorsAndLightReachesAllSensors) {
  const TemporaryFolder folder;
  for (const std::string& kind : all_kinds()) {
    const Scene scene = read_scene(write_random_room(make_random_room(kind, 2, 1), folder.path()));
    for (const Diagnostic& problem : scene.diagnostics)
      EXPECT_NE(severity_of(problem.code), Severity::error) << kind << ": " << problem.text;
    const std::vector<Sensor> sensors = all_sensors(scene.sensors);
    EXPECT_EQ(sensors.size(), 15U) << kind;
    const PathEstimate paths = trace_irradiance(scene, kept_sides(scene, Sides::both), sensors, {.paths = 512});
    EXPECT_TRUE((paths.irradiance > 0).all()) << kind;
  }
}

// Four standard errors: normal errors exceed them at one of 16,000 sensors.
TEST(RandomRooms, SolverAndPathsAgreeInRoomsWithLamps) {
  const TemporaryFolder folder;
  for (const char* kind : {"panels", "luminaires"}) {
    const Scene scene = read_scene(write_random_room(make_random_room(kind, 1, 1), folder.path()));
    Request request;
    request.mesh.patches = 500;
    request.accuracy.error_bars = true;
    const Simulation simulation = simulate(scene, request);
    const Readings readings = read_sensors(simulation).readings;
    const PathEstimate paths = trace_irradiance(simulation.world->sensor_scene(), simulation.plan.sides,
                                                all_sensors(scene.sensors), {.paths = 4096});
    const Field error = (readings.standard_error.square() + paths.standard_error.square()).sqrt();
    EXPECT_LE(((readings.irradiance - paths.irradiance).abs() / error).maxCoeff(), 4) << kind;
    EXPECT_LE((paths.standard_error / paths.irradiance).maxCoeff(), 0.1) << kind;
  }
}

}  // namespace
}  // namespace patchlight
