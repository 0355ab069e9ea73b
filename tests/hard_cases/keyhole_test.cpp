#include "patchlight/simulate.h"

#include "support/daylight_office.h"

#include <gtest/gtest.h>
#include <utility>

// The accuracy of a dim room that gets its light from a bright room through a keyhole.
namespace patchlight::keyhole_test {
namespace {

using namespace test;

// Two adjacent cubes of 2 m with a hole of 20 cm in the wall at x = 2 between them. The lamp is in the first.
Scene two_rooms_with_a_keyhole(double unit) {
  Scene scene = empty_scene({named("bright", 0.7), named("dim", 0.7), grey(0, 10)});
  const std::vector<Quad> first = box_faces(Point(0, 0, 0), Point(2, 2, 2), true);
  const std::vector<Quad> second = box_faces(Point(2, 0, 0), Point(4, 2, 2), true);
  constexpr std::size_t high_x = 3;
  constexpr std::size_t low_x = 5;
  for (std::size_t k = 0; k < 6; ++k) {
    if (k != high_x) scene = with_quad(std::move(scene), first[k], 0);
    if (k != low_x) scene = with_quad(std::move(scene), second[k], 1);
  }
  const auto piece = [&](double y0, double y1, double z0, double z1) {
    scene = with_quad(std::move(scene), {Point(2, y0, z0), Point(2, y0, z1), Point(2, y1, z1), Point(2, y1, z0)}, 0);
    scene.polygons.back().back_material = 1;
  };
  piece(0, 0.8, 0, 2);
  piece(1, 2, 0, 2);
  piece(0.8, 1, 0, 1);
  piece(0.8, 1, 1.2, 2);
  scene = with_quad(std::move(scene),
                    {Point(0.5, 0.5, 1.9), Point(0.5, 1.5, 1.9), Point(1.5, 1.5, 1.9), Point(1.5, 0.5, 1.9)}, 2);
  return turned(std::move(scene), unit);
}

Request asked_of_the_dim_room(double accuracy) {
  Request request;
  request.accuracy.relative_error = accuracy;
  request.accuracy.interest = {"dim"};
  return request;
}

TEST(Keyhole, SolverLeavesItsPartOfTheDimRoomsLightAndNoMore) {
  // The bound on all light is relative to the light of the bright room, a thousand times as much.
  constexpr double accuracy = 0.2;
  for (const double unit : {1.0, 1e-3}) {
    const Simulation simulation = simulate(two_rooms_with_a_keyhole(unit), asked_of_the_dim_room(accuracy));
    ASSERT_TRUE(simulation.solution.converged);
    for (const AccuracyStep& step : simulation.accuracy) EXPECT_LE(step.solver, 0.1 * accuracy) << step.patches;
    EXPECT_LE(simulation.accuracy.back().total, accuracy);
    EXPECT_LT(tolerance_of(simulation.plan.solver), 0.02 * accuracy);
  }
}

TEST(Keyhole, ToleranceThatIsAskedForIsTaken) {
  for (const double tolerance : {1e-9, 3e-2}) {
    Request request = asked_of_the_dim_room(0.2);
    request.solver.relative_error = tolerance;
    const Simulation simulation = simulate(two_rooms_with_a_keyhole(1), request);
    EXPECT_EQ(tolerance_of(simulation.plan.solver), tolerance);
    // If the solver's tolerance alone exceeds the accuracy, no mesh can reach it, and none is tried.
    if (tolerance > 1e-3) {
      EXPECT_EQ(simulation.accuracy.size(), 1U);
      EXPECT_GT(simulation.accuracy.back().solver, 0.2);
    }
  }
}

}  // namespace
}  // namespace patchlight::keyhole_test
