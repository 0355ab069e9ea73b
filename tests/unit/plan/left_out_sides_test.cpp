#include "patchlight/plan/plan.h"

#include "plan/notes.h"
#include "support/scenes.h"

#include <gtest/gtest.h>

namespace patchlight::left_out_sides_test {
namespace {

using namespace test;

// Two closed rooms side by side, each with its own material for the walls and the lamp.
Scene two_cells(double first_exitance, double second_exitance) {
  Scene scene = empty_scene({grey(0.5, first_exitance), grey(0.5, second_exitance)});
  scene.materials[0].name = "first";
  scene.materials[1].name = "second";
  scene = with_box(std::move(scene), Point(0, 0, 0), Point(1, 1, 1), true, 0);
  return with_box(std::move(scene), Point(2, 0, 0), Point(3, 1, 1), true, 1);
}

TEST(LeftOutSides, AreNoneWithTheSameLamps) {
  const Scene scene = two_cells(1, 0);
  for (const Sides sides : {Sides::automatic, Sides::front, Sides::both}) {
    EXPECT_TRUE(notes_on_left_out_sides(scene, kept_sides(scene, sides), sides).empty());
  }
}

TEST(LeftOutSides, OfARoomThatWasDarkAreNoted) {
  const KeptSides then = kept_sides(two_cells(1, 0), Sides::automatic);
  const std::vector<std::string> notes = texts_of(notes_on_left_out_sides(two_cells(0, 1), then, Sides::automatic));
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_NE(notes[0].find("'second'"), std::string::npos) << notes[0];
  EXPECT_EQ(notes[0].find("'first'"), std::string::npos) << notes[0];
  // The inner sides of the second room. The first room is dark inside and outside with these lamps.
  EXPECT_NE(notes[1].find(" 6 sides"), std::string::npos) << notes[1];
}

TEST(LeftOutSides, AreNoneWhereEveryFrontIsTaken) {
  const KeptSides then = kept_sides(two_cells(1, 0), Sides::front);
  EXPECT_TRUE(notes_on_left_out_sides(two_cells(0, 1), then, Sides::front).empty());
}

TEST(LeftOutSides, StayLeftOutInThePlan) {
  Request request;
  request.mesh.kept_sides = kept_sides(two_cells(1, 0), Sides::automatic);
  const Plan plan = make_plan(two_cells(1, 1), request);
  EXPECT_EQ(plan.sides.front, request.mesh.kept_sides->front);
  EXPECT_EQ(plan.sides.back, request.mesh.kept_sides->back);
  EXPECT_EQ(plan.notes.size(), 2U);
}

}  // namespace
}  // namespace patchlight::left_out_sides_test
