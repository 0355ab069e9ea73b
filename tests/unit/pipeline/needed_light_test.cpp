#include "pipeline/solve_with_rays.h"

#include <gtest/gtest.h>

namespace patchlight::needed_light_test {
namespace {

constexpr PatchIndex patches = 4;

// A field of three bands that are 1, `second` and 0 times as bright, with a value of its own on each patch.
Field dimmer_and_dark(double first_patch, double second) {
  Field field(patches, 3);
  for (Eigen::Index i = 0; i < patches; ++i)
    field.row(i) << first_patch + static_cast<double>(i), second * (first_patch + static_cast<double>(i)), 0;
  return field;
}

// Gray walls, a lamp at patch 0 outside the rows and a lamp at patch 1 in the rows, under a sky. The second band is
// 0.25 times as bright as the first, and the third is dark.
RayLight lamps_and_sky() {
  RayLight light;
  Field exitance = Field::Zero(patches, 3);
  exitance.row(0) << 8, 2, 0;
  exitance.row(1) << 4, 1, 0;
  light.lit.problem = {
      {Field::Constant(patches, 3, 0.5)}, exitance, Eigen::VectorXd::Ones(patches), dimmer_and_dark(1, 0.25)};
  light.lit.direct_standard_error = dimmer_and_dark(0.1, 0.25);
  light.is_apart = {1, 0, 0, 0};
  light.by_emitters = {dimmer_and_dark(2, 0.25), dimmer_and_dark(4, 0.25)};
  light.emitter_standard_error = dimmer_and_dark(0.2, 0.25);
  return light;
}

void expect_all_bands(const RayLight& light, const SolverOptions& options = {}) {
  EXPECT_EQ(needed_light(light, options).bands.solved, (std::vector<Eigen::Index>{0, 1, 2}));
}

TEST(NeededLight, IsThatOfOneBandWhereTheOthersFollow) {
  const RayLight light = lamps_and_sky();
  const NeededLight needed = needed_light(light, {});
  ASSERT_EQ(needed.bands.solved, std::vector<Eigen::Index>{0});
  ASSERT_EQ(needed.problem.exitance.cols(), 1);
  EXPECT_EQ(needed.problem.scattering.reflectance.cols(), 1);
  EXPECT_EQ(needed.problem.exitance(0, 0), 0) << "the light of the lamp apart is direct";
  EXPECT_EQ(needed.problem.exitance(1, 0), 4);
  for (Eigen::Index i = 0; i < patches; ++i) {
    const auto k = static_cast<double>(i);
    EXPECT_DOUBLE_EQ(needed.problem.direct_irradiance(i, 0), (3 + k) + (1 + k)) << "mean of both halves, and the sky";
    EXPECT_DOUBLE_EQ(needed.of_lamps(i, 0), (0.2 + k) * (0.2 + k));
    EXPECT_DOUBLE_EQ(needed.of_others(i, 0), (0.1 + k) * (0.1 + k));
  }
}

TEST(NeededLight, GivesTheOtherBands) {
  const RayLight light = lamps_and_sky();
  const NeededLight needed = needed_light(light, {});
  const Field all = expanded(needed.problem.direct_irradiance, needed.bands);
  const Field expected = 0.5 * (light.by_emitters[0] + light.by_emitters[1]) + light.lit.problem.direct_irradiance;
  ASSERT_EQ(all.cols(), 3);
  EXPECT_LT((all - expected).abs().maxCoeff(), 1e-14);
  EXPECT_TRUE((all.col(2) == 0).all()) << "the dark band";
}

// Light of the lamps via mirrors is direct light, too, and its error adds to that of the sky.
TEST(NeededLight, IsThatOverMirrorsAsWell) {
  RayLight light = lamps_and_sky();
  light.in_mirrors = {dimmer_and_dark(5, 0.25), dimmer_and_dark(0.3, 0.25)};
  const NeededLight needed = needed_light(light, {});
  EXPECT_EQ(needed.bands.solved, std::vector<Eigen::Index>{0});
  EXPECT_DOUBLE_EQ(needed.problem.direct_irradiance(0, 0), 3 + 1 + 5);
  EXPECT_DOUBLE_EQ(needed.of_others(0, 0), 0.1 * 0.1 + 0.3 * 0.3);
}

// Bands with another proportion of emitted or arriving light are solved separately. The dark band is not.
TEST(NeededLight, IsThatOfBandsWhoseLightDoesNotFollow) {
  RayLight light = lamps_and_sky();
  light.lit.problem.exitance(1, 1) *= 1 + 1e-9;
  EXPECT_EQ(needed_light(light, {}).bands.solved, (std::vector<Eigen::Index>{0, 1}));
}

// Each field in the result must be proportional, and so must the errors.
TEST(NeededLight, IsThatOfAllBandsWhereOneFieldDoesNotFollow) {
  for (const auto& field :
       {+[](RayLight& light) { return &light.lit.direct_standard_error; },
        +[](RayLight& light) { return &light.by_emitters[0]; }, +[](RayLight& light) { return &light.by_emitters[1]; },
        +[](RayLight& light) { return &light.emitter_standard_error; },
        +[](RayLight& light) { return &light.in_mirrors.irradiance; },
        +[](RayLight& light) { return &light.in_mirrors.standard_error; }}) {
    RayLight light = lamps_and_sky();
    light.in_mirrors = {dimmer_and_dark(5, 0.25), dimmer_and_dark(0.3, 0.25)};
    (*field(light))(1, 1) *= 1 + 1e-9;
    const NeededLight needed = needed_light(light, {});
    EXPECT_EQ(needed.bands.solved, (std::vector<Eigen::Index>{0, 1, 2}));
    EXPECT_EQ(needed.of_lamps.cols(), 3);
  }
}

// Their sum is proportional, but the emitted light is not.
TEST(NeededLight, IsThatOfAllBandsWhereEmittedAndDirectLightFollowTogetherAlone) {
  RayLight light = lamps_and_sky();
  light.lit.problem.exitance(2, 1) += 0.125;
  light.lit.problem.direct_irradiance(2, 1) -= 0.125;
  expect_all_bands(light);
}

// An error in a band without light is not an error times 0.
TEST(NeededLight, IsThatOfAllBandsWhereADarkOneHasAnError) {
  RayLight light = lamps_and_sky();
  light.emitter_standard_error(2, 2) = 0.1;
  expect_all_bands(light);
}

TEST(NeededLight, IsThatOfAllBandsWhereEachIsAskedFor) { expect_all_bands(lamps_and_sky(), {.every_band = true}); }

}  // namespace
}  // namespace patchlight::needed_light_test
