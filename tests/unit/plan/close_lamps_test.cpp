#include "plan/notes.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <gtest/gtest.h>

namespace patchlight::close_lamps_test {
namespace {

using namespace test;

// A lamp that faces the ceiling of a 4 x 3 x 2.5 m room from `gap` below.
Scene uplight(double gap) {
  const Scene room = with_box(empty_scene({grey(0.5), grey(0.5, 10)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  const double z = 2.5 - gap;
  return with_quad(room, {Point(1, 1, z), Point(2, 1, z), Point(2, 2, z), Point(1, 2, z)}, 1);
}

TEST(CloseLamps, AreNamedWithTheEdgeThatWouldDoWhereItTakesFewPatches) {
  // 61 m^2 of faces: with edges of 5 cm 24,000 patches, with 1 cm 610,000.
  const auto note = [](double gap) {
    const Scene scene = uplight(gap);
    const Diagnostics notes = notes_on_close_lamps(scene, Occluder(scene), 0.3);
    return notes.size() == 1 ? notes[0].text : std::string();
  };
  EXPECT_NE(note(0.05).find("mesh.max_edge=0.05"), std::string::npos) << note(0.05);
  EXPECT_EQ(note(0.01).find("mesh.max_edge"), std::string::npos) << note(0.01);
  EXPECT_NE(note(0.01).find("outline"), std::string::npos) << note(0.01);
}

TEST(CloseLamps, NoneWherePatchesAreSmallOrTheLampIsFar) {
  const Scene near = uplight(0.01);
  EXPECT_TRUE(notes_on_close_lamps(near, Occluder(near), 0.015).empty());
  const Scene far = uplight(1.5);
  EXPECT_TRUE(notes_on_close_lamps(far, Occluder(far), 0.3).empty());
}

}  // namespace
}  // namespace patchlight::close_lamps_test
