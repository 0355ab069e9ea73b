#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/row_tracer.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::bright_patches_test {
namespace {

using namespace test;

constexpr double threshold = 4;

// Patches of equal areas above four times the mean of these values.
std::size_t bright_of_equal_areas(const std::vector<double>& values) {
  Scene scene = empty_scene({grey(0.5)});
  const auto count = static_cast<double>(values.size());
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(count, 0, 0), Point(count, 1, 0), Point(0, 1, 0)});
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 1);
  EXPECT_EQ(mesh.size(), values.size());
  const Occluder occluder(scene, Occluder::Blockers::inside_hull);
  const Eigen::Map<const Eigen::VectorXd> expected(values.data(), static_cast<Eigen::Index>(values.size()));
  return BrightPatches(mesh, expected, threshold, occluder).size();
}

// One patch of 100 has nearly all of the variance: 8.613 of 8.615, for a mean of 0.795. Without it the others have
// 0.0025.
TEST(BrightPatches, AreThoseWithMostOfTheVariance) {
  std::vector<double> values(100, 0.5);
  values[40] = 30;
  EXPECT_EQ(bright_of_equal_areas(values), 1);
}

// A mean of 0.961: the value 4.6 is above four times that. Without it the variance is 2.11 instead of 2.24: aimed rays
// would reduce it by 6 %.
TEST(BrightPatches, AreNoneWhereMostOfTheVarianceIsThatOfOthers) {
  std::vector<double> values(100, 0.1);
  std::fill_n(values.begin(), 24, 3.5);
  values[40] = 4.6;
  EXPECT_EQ(bright_of_equal_areas(values), 0);
}

// The same with 1 of 200: 64 rays of 32 neighbors meet it only about ten times.
TEST(BrightPatches, AreSampledWhereRaysHardlyMeetThem) {
  std::vector<double> values(200, 0.1);
  std::fill_n(values.begin(), 48, 3.5);
  values[80] = 4.6;
  EXPECT_EQ(bright_of_equal_areas(values), 1);
}

// With 30 of 3.5, 69 of 0.02 and a bright one of x, the mean is 1.06 + x / 100. The variance is 2.54 without the bright
// one, and 2.54 + 0.0099 x^2 - 0.0213 x with it: 1.75 times that for x = 15.
TEST(BrightPatches, AreSampledFromTheGainOnThatPays) {
  std::vector<double> values(100, 0.02);
  std::fill_n(values.begin(), 30, 3.5);
  values[40] = 14;
  EXPECT_EQ(bright_of_equal_areas(values), 0);
  values[40] = 16;
  EXPECT_EQ(bright_of_equal_areas(values), 1);
}

TEST(BrightPatches, AreNoneOfEvenLightOrNone) {
  EXPECT_EQ(bright_of_equal_areas(std::vector<double>(100, 2)), 0);
  EXPECT_EQ(bright_of_equal_areas(std::vector<double>(100, 0)), 0);
}

}  // namespace
}  // namespace patchlight::bright_patches_test
