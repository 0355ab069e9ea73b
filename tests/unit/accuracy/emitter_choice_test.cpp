#include "accuracy/unseen_differences.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::emitter_choice_test {
namespace {

using namespace test;

// All patches of a box of 1 x 2 x 3 m are emitters. They differ in exitance and area.
struct Emitters {
  PatchMesh mesh;
  std::vector<PatchIndex> all;
  Field exitance;
};

Emitters all_of_a_box() {
  const Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(1, 2, 3), true);
  Emitters emitters{tessellate(scene, kept_sides(scene, Sides::front), 0.7), {}, {}};
  for (PatchIndex i = 0; i < emitters.mesh.size(); ++i) emitters.all.push_back(i);
  emitters.exitance = Eigen::ArrayXd::LinSpaced(emitters.mesh.size(), 1, 3);
  return emitters;
}

// at() inverts the distribution. For n evenly spaced numbers of [0, 1), n q to within one choose an emitter of
// probability q. The remainder of the number rises from 0 to 1 within each emitter.
void expect_chosen_as_told(const EmitterChoice& choice, const std::vector<PatchIndex>& emitters) {
  constexpr int count = 100'000;
  std::vector<int> chosen(emitters.size(), 0);
  EmitterChoice::Chosen before{no_patch, 0, 0};
  for (int k = 0; k < count; ++k) {
    const EmitterChoice::Chosen now = choice.at((k + 0.5) / count);
    ++chosen[now.emitter];
    EXPECT_DOUBLE_EQ(now.probability, choice.probability_of(now.emitter));
    EXPECT_TRUE(now.u >= 0 && now.u <= 1) << now.u;
    EXPECT_TRUE(now.emitter != before.emitter || now.u > before.u) << k;
    before = now;
  }
  double sum = 0;
  for (const PatchIndex emitter : emitters) {
    const double q = choice.probability_of(emitter);
    EXPECT_GT(q, 0) << "an emitter that is never chosen is missed";
    EXPECT_NEAR(chosen[emitter], count * q, 1 + 1e-6);
    sum += q;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

TEST(EmitterChoice, FollowsItsProbabilities) {
  const Emitters emitters = all_of_a_box();
  expect_chosen_as_told(choice_by_flux(emitters.mesh, emitters.all, emitters.exitance), emitters.all);
  expect_chosen_as_told(emitter_choice_for(emitters.mesh, 0, emitters.all, emitters.exitance), emitters.all);
}

TEST(EmitterChoice, ByFluxGoesWithAreaTimesExitance) {
  const Emitters emitters = all_of_a_box();
  const EmitterChoice choice = choice_by_flux(emitters.mesh, emitters.all, emitters.exitance);
  const PatchIndex last = emitters.mesh.size() - 1;
  ASSERT_GT(std::abs(emitters.mesh.area[last] / emitters.mesh.area[0] - 1), 0.01) << "else the areas are not looked at";
  const double flux_first = emitters.mesh.area[0] * emitters.exitance(0);
  const double flux_last = emitters.mesh.area[last] * emitters.exitance(last);
  EXPECT_NEAR(choice.probability_of(last) / choice.probability_of(0), flux_last / flux_first, 1e-12);
}

// A floor and a ceiling of 1 x 1 m, 2 m apart, and a wall of 1 x 2 m between them, with one patch each. The squared
// distance of middles plus the area is 4 + 1 for the ceiling and 0.25 + 1 + 2 for the wall. Both cosines of the ceiling
// are 2 / sqrt(5). Those of the wall are 1 / sqrt(3.25) and 0.5 / sqrt(3.25).
TEST(EmitterChoice, GoesWithWhatIsSentWithNothingInTheWay) {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 2), Point(0, 1, 2), Point(1, 1, 2), Point(1, 0, 2)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 1, 0), Point(0, 1, 2), Point(0, 0, 2)});
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 10);
  ASSERT_EQ(mesh.size(), 3U);
  const EmitterChoice choice = emitter_choice_for(mesh, 0, {1, 2}, Field::Ones(3, 1));
  const double of_ceiling = 1 * (4.0 / 5) / 5;
  const double of_wall = 2 * (1 * 0.5 / 3.25) / 3.25;
  EXPECT_NEAR(choice.probability_of(1), of_ceiling / (of_ceiling + of_wall), 1e-12);
}

TEST(EmitterChoice, OtherPatchesAreNeverChosen) {
  const Emitters emitters = all_of_a_box();
  const EmitterChoice choice = choice_by_flux(emitters.mesh, {3, 7}, emitters.exitance);
  EXPECT_EQ(choice.probability_of(2), 0);
  EXPECT_EQ(choice.probability_of(5), 0);
  EXPECT_EQ(choice.probability_of(8), 0);
  EXPECT_EQ(choice.at(0).emitter, 3U);
  EXPECT_EQ(choice.at(0x1.fffffffffffffp-1).emitter, 7U) << "the largest number below 1";
}

}  // namespace
}  // namespace patchlight::emitter_choice_test
