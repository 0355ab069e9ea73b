#include "support/daylight_office.h"

#include "study/verify.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

// A solution by daylight compared with paths, and the reliability of a verdict.
namespace patchlight::daylight_office_test {
namespace {

using namespace test;

Request with_error_bars(std::size_t patches) {
  Request request;
  request.mesh.patches = patches;
  request.accuracy.error_bars = true;
  return request;
}

constexpr VerifyOptions few_paths{.paths = 1024};

const VerifiedPart& part(const Verification& verification, const std::string& name) {
  for (const VerifiedPart& one : verification.parts) {
    if (one.name == name) return one;
  }
  throw std::out_of_range(name);
}

TEST(VerifyByDaylight, OfficeAgreesUntilTheSunIsTenPercentOff) {
  // The ground in the sun differs by 10 % of the sun's part, about 6 % in total, with bars and noise of 1 %.
  for (const double unit : {1.0, 1e-3}) {
    const Scene scene = unit == 1 ? daylight_office() : turned(daylight_office(), unit);
    const Simulation simulation = simulate(scene, with_error_bars(1200));
    const Field bar = simulation.error_bars->total();
    // Deep in the room few paths find the sunlit spot. With more paths, their scatter is a good estimate of their
    // noise.
    const Verification right = verify(scene, simulation, bar, {.paths = 8192});
    EXPECT_EQ(right.verdict, Verdict::agrees) << right.probability;
    EXPECT_EQ(part(right, "inside").rows.size(), 56U);
    EXPECT_EQ(part(right, "outside").rows.size(), 8U);
    for (const double factor : unit == 1 ? std::vector{0.9, 1.1} : std::vector{0.9}) {
      Scene wrong = scene;
      wrong.sun->normal_irradiance *= factor;
      const Verification verification = verify(wrong, simulation, bar, few_paths);
      EXPECT_EQ(verification.verdict, Verdict::disagrees) << factor << ' ' << verification.probability;
    }
  }
}

TEST(VerifyByDaylight, LampOfTheRoomIsSeenInsideAlone) {
  // Without its luminaire the room has less light, but the ground has the same.
  const Scene scene = daylight_office();
  const Simulation simulation = simulate(scene, with_error_bars(1200));
  Scene wrong = scene;
  wrong.luminaires.clear();
  const Verification verification = verify(wrong, simulation, simulation.error_bars->total(), few_paths);
  EXPECT_EQ(verification.verdict, Verdict::disagrees);
  EXPECT_GT(std::abs(part(verification, "inside").offset[0]), 5);
  EXPECT_LT(std::abs(part(verification, "outside").offset[0]), 3);
}

TEST(Verdict, TakesRoundingForAgreement) {
  // Light without sampling on both sides: two sums of the same numbers.
  Verification verification;
  verification.irradiance = Field{{76.000000000000007}};
  verification.bar = Field::Zero(1, 1);
  verification.paths = {Field{{76}}, Field{{1e-16}}, 1000, 0};
  EXPECT_LT(deviations(verification)(0, 0), 0.01);
  EXPECT_LT(deviations_by_noise(verification)(0, 0), 0.01);
}

TEST(Verdict, TakesNoLightMetForUpToThreePathsThatHave) {
  // Rule of three: 1,000 paths without a hit bound the fraction of hits by 3 / 1000, here of 2 W/m^2.
  Verification verification;
  verification.irradiance = Field{{0.012}, {2}};
  verification.bar = Field::Zero(2, 1);
  verification.paths = {Field{{0}, {2}}, Field{{0}, {0.01}}, 1000, 0};
  EXPECT_NEAR(deviations(verification)(0, 0), 2, 1e-12);
  EXPECT_EQ(deviations(verification)(1, 0), 0);
}

// A furnace: H = 1 on every patch, without any error of the mesh.
struct Furnace {
  Scene scene = cube_room(0.5, 0.5);
  Simulation simulation;

  explicit Furnace(double unit) {
    scene = turned(scene, unit);
    Request request;
    request.mesh.max_edge = 0.25 * unit;
    request.solver.relative_error = 1e-9;
    simulation = simulate(scene, request);
  }

  Field bar_of(double value) const { return Field::Constant(simulation.mesh.size(), 1, value); }
};

TEST(Verdict, WithWideBarsIsNeverThatBothAgree) {
  for (const double unit : {1.0, 1e-3}) {
    Furnace furnace(unit);
    Field& H = furnace.simulation.solution.irradiance;
    // 37 % too bright with bars of 45 %.
    H *= 1.37;
    Verification verification = verify(furnace.scene, furnace.simulation, furnace.bar_of(0.45), few_paths);
    EXPECT_EQ(verification.verdict, Verdict::inconclusive) << verification.probability;
    EXPECT_NEAR(verification.parts.front().mean_difference[0], 0.37, 0.02);
    // Every 40th patch is 16 times too bright, with bars of that size.
    H.setOnes();
    Field bar = furnace.bar_of(0.02);
    for (Eigen::Index i = 0; i < H.rows(); i += 40) H(i, 0) = 16, bar(i, 0) = 15;
    verification = verify(furnace.scene, furnace.simulation, bar, few_paths);
    EXPECT_EQ(verification.verdict, Verdict::inconclusive) << verification.probability;
    // Bars without that error: both differ.
    verification = verify(furnace.scene, furnace.simulation, furnace.bar_of(0.45), few_paths);
    EXPECT_EQ(verification.verdict, Verdict::disagrees) << verification.probability;
  }
}

TEST(Verdict, SeesACommonOffsetBelowTheNoiseOfPatches) {
  // Each of 64 patches has an error of 0.5 of its noise. Chi-square rises by 16, 1.4 of its standard deviations of 11.
  // It stays below 93.2, which it exceeds with a probability of 1 %. The error of the sum is 0.5 sqrt(64) = 4 of its
  // own standard deviations. With this many paths there is no second look.
  VerifyOptions paths = few_paths;
  paths.paths = 8192;
  for (const double unit : {1.0, 1e-3}) {
    Furnace furnace(unit);
    const Field none = furnace.bar_of(0);
    const Verification right = verify(furnace.scene, furnace.simulation, none, paths);
    EXPECT_EQ(right.verdict, Verdict::agrees) << right.probability;
    const double noise = std::sqrt(right.paths.standard_error.square().mean());
    furnace.simulation.solution.irradiance += 0.5 * noise;
    const Verification wrong = verify(furnace.scene, furnace.simulation, none, paths);
    EXPECT_EQ(wrong.verdict, Verdict::disagrees) << wrong.probability;
    EXPECT_LT(wrong.parts.front().chi_square[0], 93.2);
  }
}

}  // namespace
}  // namespace patchlight::daylight_office_test
