#include "patchlight/transport/lost_share.h"

#include "patchlight/mesh/mesher.h"

#include "support/scenes.h"

#include <gtest/gtest.h>
#include <utility>

namespace patchlight {
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

}  // namespace
}  // namespace patchlight
