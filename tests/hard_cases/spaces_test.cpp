#include "accuracy/spaces.h"

#include "patchlight/simulate.h"

#include "mesh/mesher.h"
#include "support/daylight_office.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>

// Inside and outside of closed shells with openings.
namespace patchlight::spaces_test {
namespace {

using namespace test;

KeptSides both_sides(const Scene& scene) {
  KeptSides sides;
  sides.front.assign(scene.polygons.size(), 1);
  sides.back.assign(scene.polygons.size(), 1);
  return sides;
}

// A point in front of a patch, in the coordinates of the office.
Point before(const PatchMesh& mesh, PatchIndex i, double unit) {
  const Eigen::AngleAxisd turn(0.7, Vector(1, 2, 3).normalized());
  return turn.inverse() * Vector((mesh.centroid[i] + 1e-4 * unit * mesh.normal[i]) / unit);
}

TEST(Spaces, PatchesAreInsideWhereTheirSideLooksIntoTheRoom) {
  for (const double unit : {1.0, 1e-3}) {
    const Scene scene = turned(daylight_office(), unit);
    const KeptSides sides = both_sides(scene);
    const PatchMesh mesh = tessellate(scene, sides, unit);
    const Eigen::VectorXd inside = inside_shells(scene, sides, mesh, Dividing::with_openings);
    const Eigen::VectorXd of_room = interest_of(scene, sides, mesh, {"room.inside"}, {});
    const Eigen::VectorXd beside = interest_of(scene, sides, mesh, {"plaster.outside", "ground"}, {});
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      const Point p = before(mesh, i, unit);
      const bool within = Box(Point(0, 0, 0), Point(4, 5, 3)).contains(p);
      EXPECT_EQ(inside[i], within ? 1 : 0);
      const std::uint32_t group = scene.polygons[mesh.polygon[i]].group;
      EXPECT_EQ(of_room[i], within && group == 0 ? 1 : 0);
      const bool plaster_outside = mesh.material[i] == 0 && !within;
      EXPECT_EQ(beside[i], plaster_outside || mesh.material[i] == 3 ? 1 : 0);
    }
    EXPECT_GT(inside.sum(), 0);
    EXPECT_LT(inside.sum(), inside.size());
  }
}

// An overhang above the window: three faces meet at its edge, so no shell is closed.
Scene with_overhang(Scene scene) {
  return with_quad(std::move(scene), {Point(0, -1.2, 3), Point(4, -1.2, 3), Point(4, 0, 3), Point(0, 0, 3)}, 0);
}

// The office without the wall that holds the pane.
Scene with_open_wall(Scene scene) {
  scene.polygons.erase(scene.polygons.begin() + 2);
  return scene;
}

Eigen::VectorXd enclosed_in(const Scene& scene, const PatchMesh& mesh) {
  return enclosed_patches(scene, Occluder(scene, Occluder::Blockers::all), mesh);
}

TEST(Spaces, RoomsAreEnclosedWhateverTheirShells) {
  // In m and in mm, above a plain of 20 km, which raises the rounding error of rays.
  const Scene office = with_overhang(daylight_office());
  const Scene on_a_plain = with_quad(
      office, {Point(-1e4, -1e4, -50), Point(1e4, -1e4, -50), Point(1e4, 1e4, -50), Point(-1e4, 1e4, -50)}, 3);
  for (const auto& [of, unit] :
       {std::pair(daylight_office(), 1.0), std::pair(office, 1e-3), std::pair(on_a_plain, 1.0)}) {
    const Scene scene = turned(of, unit);
    const KeptSides sides = both_sides(scene);
    const PatchMesh mesh = tessellate(scene, sides, unit * (of.polygons.size() > office.polygons.size() ? 100 : 1));
    const Eigen::VectorXd enclosed = enclosed_in(scene, mesh);
    const Eigen::VectorXd of_room = interest_of(scene, sides, mesh, {"room.inside"}, enclosed);
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      const bool within = Box(Point(0, 0, 0), Point(4, 5, 3)).contains(before(mesh, i, unit));
      EXPECT_EQ(enclosed[i], within ? 1 : 0) << i;
      const bool is_of_room = scene.polygons[mesh.polygon[i]].group == 0;
      EXPECT_EQ(of_room[i], within && is_of_room ? 1 : 0) << i;
    }
  }
}

TEST(Spaces, NothingIsEnclosedInTheOpen) {
  // A table top above a pavement.
  Scene scene = empty_scene({named("stone", 0.5)});
  scene = with_quad(std::move(scene), {Point(-9, -9, 0), Point(9, -9, 0), Point(9, 9, 0), Point(-9, 9, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0.8), Point(1, 0, 0.8), Point(1, 1, 0.8), Point(0, 1, 0.8)});
  EXPECT_EQ(enclosed_in(scene, tessellate(scene, both_sides(scene), 0.5)).sum(), 0);
}

TEST(Spaces, AGapBelowABuildingIsNoRoom) {
  // A block of 400 x 30 x 60 m, 10 cm above the ground.
  for (const double unit : {1.0, 1e-3}) {
    Scene scene =
        with_box(empty_scene({named("stone", 0.5)}), unit * Point(0, 0, 0.1), unit * Point(400, 30, 60), false);
    scene = with_quad(std::move(scene), {unit * Point(-999, -999, 0), unit * Point(999, -999, 0),
                                         unit * Point(999, 999, 0), unit * Point(-999, 999, 0)});
    KeptSides sides = both_sides(scene);
    sides.back.assign(scene.polygons.size(), 0);
    EXPECT_EQ(enclosed_in(scene, tessellate(scene, sides, 20 * unit)).sum(), 0);
  }
}

TEST(Spaces, AnOpenWallLeavesTheRoomInside) {
  // The opening is an eighth of the room's surface, so light survives four reflections with about (7/8)^4 = 0.59, more
  // at the back. Sixteen walks may misjudge a patch or two. Facades are outside.
  const Scene scene = turned(with_open_wall(daylight_office()), 1);
  const PatchMesh mesh = tessellate(scene, both_sides(scene), 1);
  const Eigen::VectorXd enclosed = enclosed_in(scene, mesh);
  int at_the_back = 0;
  int of_them_enclosed = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Point p = before(mesh, i, 1);
    if (!Box(Point(0, 0, 0), Point(4, 5, 3)).contains(p)) {
      EXPECT_EQ(enclosed[i], 0) << i;
    } else if (p.y() > 3.5) {
      ++at_the_back;
      of_them_enclosed += enclosed[i] == 1;
    }
  }
  EXPECT_GE(of_them_enclosed, 0.9 * at_the_back);
}

TEST(Spaces, TheErrorByDaylightIsThatInside) {
  // With the overhang no shell is closed. Most of the light is outside, so the error relative to all light is smaller.
  const Scene scene = with_overhang(daylight_office());
  Request request;
  request.mesh.patches = 600;
  request.accuracy.error_bars = true;
  const Simulation simulation = simulate(scene, request);
  ASSERT_EQ(simulation.spaces.size(), 2U);
  EXPECT_TRUE(simulation.accuracy.back().inside);
  EXPECT_EQ(simulation.accuracy.back().total, simulation.spaces[0].errors.total);
  request.accuracy.interest = {".inside", ".outside"};
  const Simulation all = simulate(scene, request);
  EXPECT_FALSE(all.accuracy.back().inside);
  EXPECT_LT(all.accuracy.back().total, simulation.accuracy.back().total);
}

TEST(Spaces, AllCountsWhereNoDaylightGetsIn) {
  // The pane is opaque, and the luminaire is off.
  Scene scene = daylight_office();
  scene.polygons[2].material = 0;
  scene.luminaires.clear();
  Request request;
  request.mesh.patches = 300;
  request.accuracy.error_bars = true;
  const Simulation simulation = simulate(scene, request);
  EXPECT_FALSE(simulation.accuracy.back().inside);
  EXPECT_TRUE(std::isfinite(simulation.accuracy.back().total));
}

TEST(Spaces, ErrorsAreStatedApart) {
  // Each error equals that of a run with interest in this side alone on the same mesh. The room has less than a tenth
  // of the light.
  const Scene scene = daylight_office();
  Request request;
  request.mesh.patches = 600;
  request.accuracy.error_bars = true;
  const Simulation simulation = simulate(scene, request);
  ASSERT_EQ(simulation.spaces.size(), 2U);
  EXPECT_EQ(simulation.spaces[0].space, "inside");
  EXPECT_EQ(simulation.spaces[0].errors.patches + simulation.spaces[1].errors.patches, simulation.mesh.size());
  request.accuracy.interest = {"room.inside", "furniture"};
  const Simulation inside = simulate(scene, request);
  EXPECT_NEAR(simulation.spaces[0].errors.total, inside.accuracy.back().total, 1e-9);
  EXPECT_TRUE(inside.spaces.empty());
  EXPECT_EQ(simulation.spaces[0].errors.total, simulation.accuracy.back().total);
}

TEST(Spaces, AreOneWhereNothingDividesThem) {
  Request request;
  request.mesh.patches = 200;
  request.accuracy.error_bars = true;
  EXPECT_TRUE(simulate(furnished_room(0.5), request).spaces.empty());
}

}  // namespace
}  // namespace patchlight::spaces_test
