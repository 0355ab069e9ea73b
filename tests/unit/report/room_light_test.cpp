#include "patchlight/report/report.h"

#include "support/scenes.h"
#include "unit/output/tiny_simulation.h"

#include <gtest/gtest.h>

namespace patchlight::room_light_test {
namespace {

constexpr std::size_t floor_of_room = 0, walls_of_room = 1, ceiling_of_room = 2;

Report report_on(const Scene& scene) {
  Request request;
  request.mesh.max_edge = 0.5;
  return report_of(scene, request, simulate(scene, request));
}

// In a furnace B = E / (1 - rho) everywhere, and H = B.
TEST(RoomLight, OfAFurnaceIsUniform) {
  const Report report = report_on(test::cube_room(0.5, 3));
  EXPECT_EQ(report.unit, "W/m^2");
  ASSERT_EQ(report.rooms.size(), 1U);
  for (const SurfaceLight& surface : report.rooms[0].surfaces) {
    EXPECT_NEAR(surface.uniformity, 1, 1e-5);
    EXPECT_NEAR(surface.mean, 6, 6e-5);
    EXPECT_NEAR(surface.area, surface.surface == RoomSurface::walls ? 4 : 1, 1e-12);
  }
}

// All light of a lamp is absorbed: Phi = sum A (1 - rho) H, in lux if lights are photometric.
TEST(RoomLight, OfARoomWithOneLampIsItsFluxOverWhatAbsorbs) {
  Scene scene = test::cube_room(0.5, 0);
  scene.materials.push_back(test::grey(0.5, 10));
  scene.polygons[1].material = 1;
  const Report report = report_on(scene);
  double flux = 0;
  for (const SurfaceLight& surface : report.rooms.at(0).surfaces) {
    flux += surface.area * 0.5 * surface.mean;
    EXPECT_LE(surface.min, surface.mean);
    EXPECT_EQ(surface.uniformity, surface.min / surface.mean);
  }
  EXPECT_NEAR(flux, 10, 1e-4);
  scene.photometric = true;
  const Report in_lux = report_on(scene);
  EXPECT_EQ(in_lux.unit, "lx");
  EXPECT_NEAR(in_lux.rooms.at(0).surfaces[0].mean, 179 * report.rooms[0].surfaces[0].mean, 1e-9);
}

// The floor of 1 m^2 has a grid with cells of 0.2 x 5^0 = 0.2 m by EN 12464-1. Each wall of 1 m^2 has the same.
TEST(RoomLight, IsCoarseOnPatchesLargerThanTheStandardsGrid) {
  const Scene scene = test::cube_room(0.5, 3);
  const auto is_coarse = [&](double edge) {
    Request request;
    request.mesh.max_edge = edge;
    const auto surfaces = report_of(scene, request, simulate(scene, request)).rooms.at(0).surfaces;
    EXPECT_EQ(surfaces[floor_of_room].is_coarse, surfaces[walls_of_room].is_coarse);
    return surfaces[floor_of_room].is_coarse;
  };
  EXPECT_TRUE(is_coarse(0.25));
  EXPECT_FALSE(is_coarse(0.18));
}

// Also if points within a patch are darker than the least mean by more than a tenth.
TEST(RoomLight, IsCoarseOnPatchesWithinWhichItDiffers) {
  Request request;
  request.mesh.max_edge = 0.1;
  const Scene scene = test::cube_room(0.5, 3);
  Simulation simulation = simulate(scene, request);
  simulation.error_bars.emplace();
  for (const double differs : {0.09, 0.11}) {
    simulation.error_bars->display = differs * simulation.solution.irradiance;
    for (const SurfaceLight& surface : report_of(scene, request, simulation).rooms.at(0).surfaces)
      EXPECT_EQ(surface.is_coarse, differs > 0.1);
  }
}

// The box in the room and the lamp below its ceiling do not bound it, whether the room has a name or is a shell.
TEST(RoomLight, LeavesOutWhatStandsInTheRoom) {
  Scene scene = test::furnished_room(0.5);
  const Report by_shell = report_on(scene);
  NamedRoom room{"A102", "", {}};
  for (const test::Quad& face : test::box_faces(Point(0, 0, 0), Point(4, 3, 2.5), false))
    room.faces.emplace_back(face.begin(), face.end());
  scene.rooms = {room};
  const Report by_name = report_on(scene);
  EXPECT_EQ(by_name.rooms.at(0).name, "A102");
  for (const Report* report : {&by_shell, &by_name}) {
    ASSERT_EQ(report->rooms.size(), 1U);
    EXPECT_NEAR(report->rooms[0].surfaces[floor_of_room].area, 12, 1e-9);
    EXPECT_NEAR(report->rooms[0].surfaces[walls_of_room].area, 35, 1e-9);
    EXPECT_NEAR(report->rooms[0].surfaces[ceiling_of_room].area, 12, 1e-9);
  }
}

// In gbXML, rooms end at the inner sides of walls that are drawn by their middle planes, and at ceilings below floors.
// Patches at edges, beside the body, may be omitted. The lamp below the ceiling counts as another ceiling.
TEST(RoomLight, TakesWallsThatStandOutsideOfTheBody) {
  Scene scene = test::furnished_room(0.5);
  NamedRoom room{"A102", "", {}};
  for (const test::Quad& face : test::box_faces(Point(0.1, 0.1, 0.1), Point(3.9, 2.9, 2.1), false))
    room.faces.emplace_back(face.begin(), face.end());
  scene.rooms = {room};
  const Report report = report_on(scene);
  ASSERT_EQ(report.rooms.size(), 1U);
  const auto& surfaces = report.rooms[0].surfaces;
  EXPECT_GE(surfaces[floor_of_room].area, 0.85 * 12);
  EXPECT_LE(surfaces[floor_of_room].area, 12 + 1e-9);
  EXPECT_GE(surfaces[walls_of_room].area, 0.8 * 35);
  EXPECT_LE(surfaces[walls_of_room].area, 35 + 1e-9);
  EXPECT_GE(surfaces[ceiling_of_room].area, 0.85 * 12);
  EXPECT_LE(surfaces[ceiling_of_room].area, 12 + 1);
}

// The body of the room ends 10 cm above the floor, so more distant faces count. A layer within the slab under the floor
// does not count, though it is lit.
TEST(RoomLight, LeavesOutLayersWithinASlab) {
  Scene scene = test::furnished_room(0.5);
  scene.materials.push_back(test::grey(0.5, 1));
  const MaterialIndex lit = static_cast<MaterialIndex>(scene.materials.size() - 1);
  scene = test::with_box(std::move(scene), Point(0, 0, -0.4), Point(4, 3, -0.2), false, lit);
  NamedRoom room{"A102", "", {}};
  for (const test::Quad& face : test::box_faces(Point(0.1, 0.1, 0.1), Point(3.9, 2.9, 2.1), false))
    room.faces.emplace_back(face.begin(), face.end());
  scene.rooms = {room};
  Request request;
  request.mesh.max_edge = 0.5;
  request.mesh.sides = Sides::both;
  const Simulation simulation = simulate(scene, request);
  const Report report = report_of(scene, request, simulation);
  ASSERT_EQ(report.rooms.size(), 1U);
  EXPECT_LE(report.rooms[0].surfaces[floor_of_room].area, 12 + 1e-9);
}

TEST(RoomLight, TakesFloorsByTheAxisThatIsUp) {
  Scene scene = test::furnished_room(0.5);
  scene.up = Vector::UnitY();
  const Report report = report_on(scene);
  EXPECT_NEAR(report.rooms.at(0).surfaces[floor_of_room].area, 10, 1e-9);
  EXPECT_NEAR(report.rooms.at(0).surfaces[walls_of_room].area, 39, 1e-9);
}

// The same within a wall of a closed model.
TEST(RoomLight, LeavesOutPatchesThatNoLightReaches) {
  Simulation simulation = tiny_simulation();
  EXPECT_EQ(report_of(tiny_scene(), {}, simulation).rooms.at(0).surfaces[floor_of_room].area, 1);
  simulation.solution.irradiance.row(0) = 0;
  EXPECT_EQ(report_of(tiny_scene(), {}, simulation).rooms.at(0).surfaces[floor_of_room].area, 0);
  simulation.solution.irradiance = 0;
  EXPECT_TRUE(report_of(tiny_scene(), {}, simulation).rooms.empty());
}

}  // namespace
}  // namespace patchlight::room_light_test
