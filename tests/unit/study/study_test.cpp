#include "study/study.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::study_test {
namespace {

using namespace test;

Request request_for(std::size_t patches) {
  Request request;
  request.mesh.patches = patches;
  request.mesh.sides = Sides::front;
  return request;
}

constexpr StudyOptions quick{.sizes = 3, .adaptive = false, .estimators = false};

// B = E + rho o H of a furnace by definition: B = c everywhere if E = c (1 - rho).
TEST(Furnace, IsSeenByItsMaterials) {
  RadiosityProblem problem{{Field::Constant(3, 1, 0.25)}, Field::Constant(3, 1, 1.5), Eigen::Vector3d(1, 2, 3)};
  ASSERT_TRUE(furnace_radiosity(problem));
  EXPECT_DOUBLE_EQ((*furnace_radiosity(problem))[0], 2);
  problem.scattering.reflectance(1, 0) = 0.75;
  problem.exitance(1, 0) = 0.5;
  EXPECT_TRUE(furnace_radiosity(problem));
  problem.exitance(1, 0) = 0.5 + 1e-6;
  EXPECT_FALSE(furnace_radiosity(problem));
  problem.exitance.setZero();
  EXPECT_FALSE(furnace_radiosity(problem));  // no light at all
}

TEST(Study, OfAFurnaceHasTheClosedFormForReference) {
  const Study found = study(cube_room(0.7, 0.3), request_for(400), quick);
  EXPECT_TRUE(found.reference.closed_form);
  EXPECT_EQ(found.reference.bar, 0);
  // Any mesh gives the solution, to the solver's tolerance.
  for (const StudySweep& sweep : found.sweeps) {
    for (const StudySetting& setting : sweep.settings) EXPECT_LE(setting.error, std::max(1e-6, setting.tolerance));
  }
  EXPECT_EQ(price_of(0.01, found).finding, Finding::at_most);
}

TEST(Study, WithoutReflectionHasNoErrors) {
  const Study found = study(furnished_room(0), request_for(300), quick);
  EXPECT_FALSE(found.reference.closed_form);
  for (const StudySweep& sweep : found.sweeps) {
    for (const StudySetting& setting : sweep.settings) EXPECT_EQ(setting.error, 0);
  }
}

TEST(Study, ChangesOneQuantityAtATime) {
  const Study found = study(furnished_room(0.7), request_for(600), quick);
  ASSERT_EQ(found.sweeps.size(), 4u);
  const StudySweep& sizes = found.sweeps[0];
  const StudySetting& finest = sizes.settings.back();
  for (const StudySetting& setting : sizes.settings) {
    EXPECT_EQ(setting.samples, finest.samples);
    EXPECT_EQ(setting.tolerance, finest.tolerance);
    // The spread within patches is part of the display error.
    EXPECT_GT(setting.display_error, setting.error);
    EXPECT_GT(cpu_seconds_of(setting), 0);
  }
  for (std::size_t k = 1; k < sizes.settings.size(); ++k) {
    EXPECT_GT(sizes.settings[k].patches, 2 * sizes.settings[k - 1].patches);
    EXPECT_LT(sizes.settings[k].display_error, sizes.settings[k - 1].display_error);
  }
  for (const std::size_t sweep : {2, 3}) {
    for (const StudySetting& setting : found.sweeps[sweep].settings) EXPECT_EQ(setting.patches, finest.patches);
  }
  // Four times the patches and the samples.
  EXPECT_GT(found.reference.patches, 3 * finest.patches);
  EXPECT_GE(found.reference.samples, 4 * finest.samples);
  // A solver stops below its tolerance.
  for (const StudySetting& setting : found.sweeps[3].settings) EXPECT_LE(setting.own_error, 1.2 * setting.tolerance);
  EXPECT_GT(found.parts.mesh, 0);
  // A part of a sum: at most all of it, to rounding.
  EXPECT_LE(found.parts.worst_share, 1 + 1e-12);
}

TEST(Study, IsOfLittleUseWhereLightIsTrapped) {
  Scene scene = cube_room(1, 1);
  const Study found = study(scene, request_for(100), quick);
  EXPECT_FALSE(found.trapped.empty());
  EXPECT_TRUE(found.sweeps.empty());
}

TEST(Discrepancy, OfASolutionFromItselfIsNone) {
  const Simulation simulation = simulate(furnished_room(0.7), request_for(300));
  const Discrepancy found = discrepancy(simulation, reference_from(simulation));
  // Means over the same patches: only rounding, and the error of 1e-16 in the variance's difference of squares.
  EXPECT_LT(found.of_means, 1e-12);
  EXPECT_LT(found.of_display, 1e-6);
}

TEST(Discrepancy, IsRelativeToTheReflectedLight) {
  const Simulation simulation = simulate(furnished_room(0.7), request_for(300));
  Simulation darker = simulation;
  const Field& E = simulation.problem.exitance;
  darker.solution.radiosity = E + 0.9 * (simulation.solution.radiosity - E);
  const Discrepancy found = discrepancy(darker, reference_from(simulation));
  EXPECT_NEAR(found.of_means, 0.1, 1e-12);
  EXPECT_NEAR(found.squares.sum(), 0.01, 1e-12);
}

}  // namespace
}  // namespace patchlight::study_test
