#include "accuracy/spaces.h"

#include "patchlight/simulate.h"

#include "accuracy/interest.h"
#include "mesh/mesher.h"
#include "support/daylight_office.h"

#include <gtest/gtest.h>

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

// Just before a patch, in the office's own coordinates.
Point before(const PatchMesh& mesh, PatchIndex i, double unit) {
  const Eigen::AngleAxisd turn(0.7, Vector(1, 2, 3).normalized());
  return turn.inverse() * Vector((mesh.centroid[i] + 1e-4 * unit * mesh.normal[i]) / unit);
}

TEST(Spaces, PatchesAreInsideWhereTheirSideLooksIntoTheRoom) {
  for (const double unit : {1.0, 1e-3}) {
    const Scene scene = turned(daylight_office(), unit);
    const PatchMesh mesh = tessellate(scene, both_sides(scene), unit);
    const Eigen::VectorXd inside = inside_shells(scene, mesh, Dividing::with_openings);
    const Eigen::VectorXd of_room = interest_of(scene, mesh, {"room.inside"});
    const Eigen::VectorXd beside = interest_of(scene, mesh, {"plaster.outside", "ground"});
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

TEST(Spaces, ErrorsAreStatedApart) {
  // Each as an interest in that side alone states it, on the same mesh. Of the light the room has less than a tenth.
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
  EXPECT_GT(simulation.spaces[0].errors.total, simulation.accuracy.back().total);
}

TEST(Spaces, AreOneWhereNothingDividesThem) {
  Request request;
  request.mesh.patches = 200;
  request.accuracy.error_bars = true;
  EXPECT_TRUE(simulate(furnished_room(0.5), request).spaces.empty());
}

}  // namespace
}  // namespace patchlight::spaces_test
