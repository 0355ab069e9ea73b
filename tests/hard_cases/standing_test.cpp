// Solids that only the face they stand on closes.
#include "patchlight/simulate.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>

namespace patchlight::standing_test {
namespace {

using namespace test;

// A room with a lamp under its ceiling and a block on its floor, whose bottom is the 13th polygon, if it has one.
Scene room_with_block(bool bottom) {
  Scene scene = with_box(empty_scene({grey(0.6), grey(0, 10)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  scene =
      with_quad(std::move(scene), {Point(1.5, 1, 2.4), Point(1.5, 2, 2.4), Point(2.5, 2, 2.4), Point(2.5, 1, 2.4)}, 1);
  for (const Quad& face : box_faces(Point(1.1, 0.9, 0), Point(2.3, 1.7, 1), false)) {
    const bool is_bottom = face[0].z() + face[1].z() + face[2].z() == 0;
    if (bottom || !is_bottom) scene = with_quad(std::move(scene), face);
  }
  return scene;
}

// Patches of the floor that reach under the block send no light into it: it is dark inside, and elsewhere the light is
// that around a closed block, within the bars. A bar of a patch is one standard error of either solution.
TEST(StandingBlock, WithoutABottomIsDarkInside) {
  Request request;
  request.mesh.patches = 300;
  request.accuracy.error_bars = true;
  const Simulation open = simulate(room_with_block(false), request);
  const Simulation closed = simulate(room_with_block(true), request);
  for (PatchIndex i = 0; i < open.mesh.size(); ++i) {
    const bool of_block = open.mesh.polygon[i] >= 7;
    EXPECT_TRUE(!of_block || open.mesh.side[i] == Side::front) << "patch " << i;
  }
  const Field bar_open = open.error_bars->total();
  const Field bar_closed = closed.error_bars->total();
  // The room's own patches are the same in both.
  PatchIndex compared = 0;
  double largest = 0;
  for (PatchIndex i = 0; i < std::min(open.mesh.size(), closed.mesh.size()) && open.mesh.polygon[i] < 6; ++i) {
    ASSERT_EQ(open.mesh.centroid[i], closed.mesh.centroid[i]);
    const double bar = std::hypot(bar_open(i, 0), bar_closed(i, 0));
    largest = std::max(largest, std::abs(open.solution.radiosity(i, 0) - closed.solution.radiosity(i, 0)) / bar);
    ++compared;
  }
  EXPECT_GT(compared, 100U);
  EXPECT_LT(largest, 4);
}

}  // namespace
}  // namespace patchlight::standing_test
