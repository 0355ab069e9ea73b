#include "patchlight/transport/lost_share.h"

#include "patchlight/mesh/mesher.h"

#include "support/scenes.h"

#include <gtest/gtest.h>
#include <utility>

namespace patchlight::lost_share_test {
namespace {

using namespace test;

// A room of 3 x 3 x 3 m; its floor is one patch, on which a box without a bottom covers this rectangle.
LostShare lost_under_box(const Point& low, const Point& high) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(3, 3, 3), true);
  const std::vector<Quad> faces = box_faces(low, high, false);
  for (std::size_t face = 1; face < faces.size(); ++face) scene = with_quad(std::move(scene), faces[face]);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 9);
  return measure_lost_share(mesh, Occluder(scene), 1024, 1);
}

// Rays start from all over a patch, wherever it is that they see backs. The 128 starting points are stratified: they
// know the share of a rectangle to a few hundredths, 4 / 128.
TEST(LostShare, FindsTheCoveredShareAnywhere) {
  const double expected = 2.8 / 9;
  const std::array<std::pair<Point, Point>, 4> boxes{{{Point(0.1, 0.1, 0), Point(1.1, 2.9, 1)},
                                                      {Point(1.9, 0.1, 0), Point(2.9, 2.9, 1)},
                                                      {Point(0.1, 0.1, 0), Point(2.9, 1.1, 1)},
                                                      {Point(0.1, 1.9, 0), Point(2.9, 2.9, 1)}}};
  for (const auto& [low, high] : boxes) {
    const LostShare lost = lost_under_box(low, high);
    EXPECT_NEAR(lost.covered[0], expected, 4.0 / 128);
    EXPECT_EQ(lost.escaped.sum() + lost.at_backs.sum(), 0);
  }
}

// What is known is not measured again: here it is made up.
TEST(LostShare, OfKnownPatchesIsTakenOver) {
  const Scene scene = test::furnished_room(0.5);
  const Occluder occluder(scene);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 1);
  LostShare before = measure_lost_share(mesh, occluder, 64, 1);
  std::vector<PatchIndex> place(mesh.size(), no_patch);
  EXPECT_EQ(measure_lost_share(mesh, occluder, KnownShares{before, place}, 1).escaped, before.escaped);
  before.escaped[3] = before.at_backs[3] = before.covered[3] = before.dark[3] = 0.25;
  place[5] = 3;
  const LostShare taken_over = measure_lost_share(mesh, occluder, KnownShares{before, place}, 1);
  EXPECT_EQ(taken_over.rays_per_patch, 64);
  for (const auto share : {&LostShare::escaped, &LostShare::at_backs, &LostShare::covered, &LostShare::dark}) {
    EXPECT_EQ((taken_over.*share)[5], 0.25);
    EXPECT_NE((taken_over.*share)[3], 0.25);
  }
}

}  // namespace
}  // namespace patchlight::lost_share_test
