#include "patchlight/gather/gather.h"

#include "patchlight/mesh/mesher.h"
#include "patchlight/scene/sides.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight {
namespace {

using namespace test;

PatchMesh fronts(const Scene& scene, double max_edge) {
  return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
}

TEST(GatherIrradiance, InAClosedRoomOfUnitRadiosityIsOneAnywhereInAnyDirection) {
  // The form factors of all patches seen from a point add up to 1, in closed form: only rounding is left.
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.3);
  const Field ones = Field::Ones(mesh.size(), 1);
  const std::vector<Sensor> sensors{{Point(0.5, 0.5, 0.5), Vector::UnitZ()},
                                    {Point(0.1, 0.9, 0.3), Vector(1, -2, 0.5).normalized()},
                                    {Point(0.4, 0.3, 0), Vector::UnitZ()}};
  const Field irradiance = gather_irradiance(mesh, ones, ones, Occluder(scene), sensors).irradiance;
  EXPECT_LT((irradiance - 1).abs().maxCoeff(), 1e-12);
}

TEST(GatherIrradiance, BelowALampFollowsLambert) {
  // Half of the lamp is hidden by a plate whose edge lies below the lamp's middle: by symmetry half of the closed form.
  Scene scene = empty_scene({grey(0), grey(0, 7)});
  scene = with_quad(std::move(scene), {Point(-1, -1, 0), Point(1, -1, 0), Point(1, 1, 0), Point(-1, 1, 0)});
  scene = with_quad(std::move(scene), {Point(-.2, -.2, 1), Point(-.2, .2, 1), Point(.2, .2, 1), Point(.2, -.2, 1)}, 1);
  scene = with_quad(std::move(scene), {Point(0, -.5, .5), Point(0, .5, .5), Point(.5, .5, .5), Point(.5, -.5, .5)});
  const PatchMesh mesh = fronts(scene, 10);
  Field exitance = Field::Zero(mesh.size(), 1);
  exitance(1, 0) = 7;
  const std::vector<Sensor> sensors{{Point(0, 0, 0), Vector::UnitZ()}};
  GatherOptions options;
  options.emitter_samples = 1024;
  const double root = std::sqrt(1.04);
  const double whole = 7 * 4 / std::numbers::pi * 0.2 / root * std::atan(0.2 / root);
  const Field irradiance = gather_irradiance(mesh, exitance, exitance, Occluder(scene), sensors, options).irradiance;
  // 1024 Owen-scrambled points resolve a straight edge to about 1 / sqrt(1024) / 10.
  EXPECT_NEAR(irradiance(0, 0), 0.5 * whole, 0.005 * whole);
}

TEST(GatherIrradiance, SeesNothingThroughTheFloor) {
  const Scene scene = cube_room(0.5, 0.5);
  const PatchMesh mesh = fronts(scene, 0.5);
  const Field ones = Field::Ones(mesh.size(), 1);
  const std::vector<Sensor> below{{Point(0.5, 0.5, -0.5), Vector::UnitZ()}, {Point(0.5, 0.5, 0), -Vector::UnitZ()}};
  const Occluder occluder(scene, Occluder::Blockers::all);
  const Field irradiance = gather_irradiance(mesh, ones, ones, occluder, below).irradiance;
  EXPECT_EQ(irradiance(0, 0), 0);
  EXPECT_EQ(irradiance(1, 0), 0);
}

}  // namespace
}  // namespace patchlight
