#include "pipeline/radiosity_errors.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::relative_errors_test {
namespace {

constexpr PatchIndex patches = 1800;

// All patches have bars of 0.3 of the light in the first band, and twice that in the second one. On half of them, all
// but `left` of the square is noise.
Simulation with_noise(double left) {
  Simulation simulation;
  RadiosityProblem& problem = simulation.problem;
  problem = {{Field::Constant(patches, 2, 0.5)}, Field::Zero(patches, 2), Eigen::VectorXd::Ones(patches)};
  const Field H = Field::Constant(patches, 2, 2);
  simulation.solution.irradiance = H;
  simulation.solution.radiosity = problem.scattering.reflect(H);
  Field bar = 0.3 * H;
  bar.col(1) *= 2;
  Field noise = Field::Zero(patches, 2);
  noise.topRows(patches / 2) = std::sqrt(1 - left) * bar.topRows(patches / 2);
  simulation.error_bars = {.mesh = bar, .mesh_noise = noise, .form_factor = 0 * H, .solver = 0 * H, .display = 0 * H};
  return simulation;
}

// Error of the second band, the worse one.
double of_mesh(const Simulation& simulation, const Eigen::VectorXd& weight) {
  const AccuracyStep errors = errors_of(simulation, weight);
  EXPECT_DOUBLE_EQ(errors.total, errors.mesh);
  return errors.mesh / 2;
}

// The root of the squares without noise plus their standard error: sqrt(11 / n) of the root mean square of the parts,
// because patches nearby share an estimate.
TEST(RelativeErrors, AddUpWithoutTheirNoise) {
  const Eigen::VectorXd all = Eigen::VectorXd::Ones(patches);
  EXPECT_NEAR(of_mesh(with_noise(1), all), 0.3, 1e-12) << "nothing is noise";
  const double n = patches;
  EXPECT_NEAR(of_mesh(with_noise(0), all), 0.3 * std::sqrt(0.5 + std::sqrt(11 * 0.5 / n)), 1e-12);
  EXPECT_NEAR(of_mesh(with_noise(-0.5), all), 0.3 * std::sqrt(0.25 + std::sqrt(11 * 0.5 * 1.25 / n)), 1e-12);
}

// For a few patches the sum is uncertain, so it does not exceed the bars.
TEST(RelativeErrors, OfFewPatchesAreTheirBars) {
  Eigen::VectorXd few = Eigen::VectorXd::Zero(patches);
  few.head(4).setOnes();
  EXPECT_NEAR(of_mesh(with_noise(-1), few), 0.3, 1e-12);
  few.head(900).setOnes();
  EXPECT_NEAR(of_mesh(with_noise(-1), few), 0.3 * std::sqrt(std::sqrt(11.0 / 900)), 1e-12)
      << "never below what is known";
}

TEST(RelativeErrors, AreThoseOfTheBarsWhereNothingIsKnownOfNoise) {
  Simulation simulation = with_noise(0);
  simulation.error_bars->mesh_noise = {};
  EXPECT_NEAR(of_mesh(simulation, Eigen::VectorXd::Ones(patches)), 0.3, 1e-12);
}

}  // namespace
}  // namespace patchlight::relative_errors_test
