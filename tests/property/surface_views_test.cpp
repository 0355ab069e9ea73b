// Sensors, final pictures and paths give one irradiance at places of opaque matte surfaces.
#include "patchlight/input/read_scene.h"
#include "patchlight/simulate.h"
#include "patchlight/views/views.h"

#include "pipeline/world.h"
#include "support/random_rooms.h"
#include "support/surface_places.h"
#include "unit/output/temporary_folder.h"
#include "verify/path_tracer.h"

#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace patchlight {
namespace {

using namespace test;

// Pictures of a place: their scatter has 15 degrees of freedom, and that of the paths 31.
constexpr std::uint32_t pictures = 16;

// Student's t with 15 degrees of freedom is beyond 5 once in 6,000 draws.
constexpr double most_errors = 5;

constexpr std::size_t places_per_room = 12;

double largest_z(const Field& difference, const Field& a, const Field& b) {
  // Rounding alone separates values without an error.
  const Field error = (a.square() + b.square()).sqrt().max(1e-12);
  return (difference.abs() / error).maxCoeff();
}

std::vector<SurfacePlace> places_that_count(const Simulation& simulation) {
  std::vector<SurfacePlace> some;
  for (const SurfacePlace& place : draw_surface_places(simulation, 4 * places_per_room, 1))
    if (place.counts && some.size() < places_per_room) some.push_back(place);
  return some;
}

void expect_agreement(const std::string& kind, std::size_t number) {
  const TemporaryFolder folder;
  const RandomRoom room = make_random_room(kind, number, 1, RoomOptics::mixed);
  const Scene scene = read_scene(write_random_room(room, folder.path()));
  Request request;
  request.mesh.patches = 800;
  request.accuracy.error_bars = true;
  const Simulation simulation = simulate(scene, request);
  const std::vector<SurfacePlace> places = places_that_count(simulation);
  ASSERT_EQ(places.size(), places_per_room) << room.name;
  std::vector<Sensor> sensors;
  for (const SurfacePlace& place : places) sensors.push_back(place.sensor);

  const Readings readings = read_sensors(simulation, {{.name = "places", .sensors = sensors}}).readings;
  const PlaceIrradiance pixels = picture_irradiance(simulation, places, pictures);
  const PathEstimate paths =
      trace_irradiance(simulation.world->sensor_scene(), simulation.plan.sides, sensors, {.paths = 8192});
  // Sensors and pictures share the errors of the solution.
  const Field of_pixels = (pixels.standard_error.square() + readings.standard_error.square()).sqrt();
  EXPECT_LE(largest_z(readings.irradiance - paths.irradiance, readings.standard_error, paths.standard_error),
            most_errors)
      << room.name;
  EXPECT_LE(largest_z(pixels.irradiance - paths.irradiance, of_pixels, paths.standard_error), most_errors) << room.name;
  EXPECT_LE(largest_z(pixels.irradiance - readings.irradiance, pixels.standard_error, readings.standard_error),
            most_errors)
      << room.name;
}

TEST(SurfaceViews, SensorsPicturesAndPathsAgreeByDaylight) { expect_agreement("furniture", 1); }

TEST(SurfaceViews, SensorsPicturesAndPathsAgreeBetweenColoredMirrorsAndPanes) { expect_agreement("mirrors", 0); }

TEST(SurfaceViews, SensorsPicturesAndPathsAgreeByLuminaires) { expect_agreement("luminaires", 1); }

}  // namespace
}  // namespace patchlight
