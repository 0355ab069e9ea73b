#include "accuracy/choice_of_lamps.h"

#include "mesh/mesher.h"
#include "support/scenes.h"

#include <gtest/gtest.h>
#include <vector>

namespace patchlight::choice_of_lamps_test {
namespace {

using namespace test;

// All patches of a cube as lamps, each of another exitance.
struct Lamps {
  PatchMesh mesh;
  std::vector<PatchIndex> all;
  Field exitance;
};

Lamps all_of_a_cube() {
  const Scene scene = cube_room(0.5, 1);
  Lamps lamps{tessellate(scene, kept_sides(scene, Sides::front), 0.3), {}, {}};
  for (PatchIndex i = 0; i < lamps.mesh.size(); ++i) lamps.all.push_back(i);
  lamps.exitance = Eigen::ArrayXd::LinSpaced(lamps.mesh.size(), 1, 3);
  return lamps;
}

// at() is the inverse of the distribution: k numbers of [0, 1), evenly spaced, give each lamp k q_j of them within one,
// and what is left of a number is a number again, in rising order within a lamp.
void expect_chosen_as_told(const ChoiceOfLamps& choice, const std::vector<PatchIndex>& lamps) {
  constexpr int count = 100'000;
  std::vector<int> chosen(lamps.size(), 0);
  ChoiceOfLamps::Chosen before{no_patch, 0, 0};
  for (int k = 0; k < count; ++k) {
    const ChoiceOfLamps::Chosen now = choice.at((k + 0.5) / count);
    ++chosen[now.lamp];
    EXPECT_DOUBLE_EQ(now.probability, choice.probability_of(now.lamp));
    EXPECT_TRUE(now.u >= 0 && now.u <= 1) << now.u;
    EXPECT_TRUE(now.lamp != before.lamp || now.u > before.u) << k;
    before = now;
  }
  double sum = 0;
  for (const PatchIndex lamp : lamps) {
    const double q = choice.probability_of(lamp);
    EXPECT_GT(q, 0) << "a lamp that is never chosen is missed";
    EXPECT_NEAR(chosen[lamp], count * q, 1 + 1e-6);
    sum += q;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(ChoiceOfLamps, FollowsItsProbabilities) {
  const Lamps lamps = all_of_a_cube();
  expect_chosen_as_told(choice_by_flux(lamps.mesh, lamps.all, lamps.exitance), lamps.all);
  expect_chosen_as_told(choice_of_lamps(lamps.mesh, 0, lamps.all, lamps.exitance), lamps.all);
}

TEST(ChoiceOfLamps, ByFluxGoesWithAreaTimesExitance) {
  const Lamps lamps = all_of_a_cube();
  const ChoiceOfLamps choice = choice_by_flux(lamps.mesh, lamps.all, lamps.exitance);
  const double flux_0 = lamps.mesh.area[0] * lamps.exitance(0);
  const double flux_9 = lamps.mesh.area[9] * lamps.exitance(9);
  EXPECT_NEAR(choice.probability_of(9) / choice.probability_of(0), flux_9 / flux_0, 1e-12);
}

TEST(ChoiceOfLamps, OtherPatchesAreNeverChosen) {
  const Lamps lamps = all_of_a_cube();
  const ChoiceOfLamps choice = choice_by_flux(lamps.mesh, {3, 7}, lamps.exitance);
  EXPECT_EQ(choice.probability_of(2), 0);
  EXPECT_EQ(choice.probability_of(5), 0);
  EXPECT_EQ(choice.probability_of(8), 0);
  EXPECT_EQ(choice.at(0).lamp, 3U);
  EXPECT_EQ(choice.at(0x1.fffffep-1).lamp, 7U);
}

}  // namespace
}  // namespace patchlight::choice_of_lamps_test
