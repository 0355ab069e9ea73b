#include "patchlight/accuracy/error_bars.h"

#include "patchlight/simulate.h"

#include "accuracy/errors.h"
#include "accuracy/refinement.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "transport/random_errors.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>

namespace patchlight::error_bars_test {
namespace {

Request with_bars(std::size_t patches) {
  Request request;
  request.mesh.patches = patches;
  request.accuracy.error_bars = true;
  return request;
}

// In a furnace, B = 1 for patches of any size, and closure removes all sampling errors from the row sums. The bars must
// reflect that. The rest is the tolerances of the closure and the solver and the storage as floats.
TEST(ErrorBars, VanishInAFurnace) {
  Request request = with_bars(400);
  request.solver.relative_error = 1e-9;
  const Simulation simulation = simulate(test::cube_room(0.5, 0.5), request);
  ASSERT_TRUE(simulation.error_bars);
  EXPECT_LT((simulation.solution.irradiance - 1).abs().maxCoeff(), 1e-6);
  EXPECT_LT(simulation.error_bars->mesh.maxCoeff(), 1e-5);
  EXPECT_LT(simulation.error_bars->solver.maxCoeff(), 1e-6);
  EXPECT_LT(simulation.error_bars->display.maxCoeff(), 1e-5);
}

// The parts add up in quadrature, for each patch and as a whole.
TEST(ErrorBars, AddUpInQuadrature) {
  const Simulation simulation = simulate(test::furnished_room(0.5), with_bars(600));
  const ErrorBars& bars = *simulation.error_bars;
  const Field squares = bars.mesh.square() + bars.form_factor.square() + bars.solver.square();
  EXPECT_LT((bars.total().square() - squares).abs().maxCoeff(), 1e-14 * squares.maxCoeff());
  EXPECT_GT(bars.mesh.minCoeff(), 0);
  EXPECT_GT(bars.form_factor.maxCoeff(), 0);
  ASSERT_EQ(simulation.accuracy.size(), 1U);
  const AccuracyStep& step = simulation.accuracy[0];
  // With one band, the worst band is the same for all.
  EXPECT_NEAR(step.total, std::hypot(step.mesh, step.form_factor, step.solver), 1e-12);
  EXPECT_GT(step.display, step.mesh);
}

// ||rho bar||_A / ||B - E||_A by hand: A = 1, 3; rho = 0.5, 1; bar = 2, 1; B - E = 3, 4.
TEST(RelativeBar, IsRelativeToTheReflectedLight) {
  const RadiosityProblem problem{{Eigen::Array2d(0.5, 1)}, Eigen::Array2d(7, 0), Eigen::Vector2d(1, 3)};
  Solution solution;
  solution.radiosity = Eigen::Array2d(10, 4);
  const Field bar = Eigen::Array2d(2, 1);
  EXPECT_DOUBLE_EQ(relative_bar(bar, problem, solution, Eigen::Vector2d(1, 1)), std::sqrt((1.0 + 3) / (9 + 3 * 16)));
  EXPECT_DOUBLE_EQ(relative_bar(bar, problem, solution, Eigen::Vector2d(0, 1)), 0.25);
  EXPECT_EQ(relative_bar(bar, problem, solution, Eigen::Vector2d(0, 0)), 0);
}

// An error without a bound is infinite, even if one of the patches reflects none of it.
TEST(RelativeBar, IsInfiniteWhereNoBoundIsKnown) {
  const RadiosityProblem problem{{Eigen::Array2d(0.5, 0)}, Eigen::Array2d(7, 0), Eigen::Vector2d(1, 3)};
  Solution solution;
  solution.radiosity = Eigen::Array2d(10, 0);
  solution.irradiance = Eigen::Array2d(6, 1);
  const Field bar = solver_errors({problem, solution});
  EXPECT_TRUE(std::isinf(relative_bar(bar, problem, solution, Eigen::Vector2d(1, 1))));
}

// Two patches send light to a black third one. F = S for patches of 1 m^2. An error of one patch arrives as rho F times
// the error. The signs of the common errors 0.3 and 0.1 are random: their root mean square lies between the difference
// and the sum.
TEST(ErrorsOfLights, AreFollowedToWhatTheLitPatchesLight) {
  Scene scene = test::empty_scene({test::grey(0.5)});
  for (const double x : {0.0, 2.0, 4.0})
    scene = test::with_quad(std::move(scene), {Point(x, 0, 0), Point(x + 1, 0, 0), Point(x + 1, 1, 0), Point(x, 1, 0)});
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 10);
  ASSERT_EQ(mesh.size(), 3U);
  ExchangeAreas S(3);
  S.set(0, 2, 0.3F);
  S.set(1, 2, 0.2F);
  const Eigen::VectorXd area = Eigen::VectorXd::Ones(3);
  const auto transport = dense_transport(keep_exchange_areas(std::move(S), ""), area);
  const RadiosityProblem problem{{Eigen::Array3d(0.5, 0.5, 0)}, Field::Zero(3, 1), area};

  constexpr double single_precision = 1e-6;
  const auto errors_of_lights = [&](const Field& standard_error) -> Field {
    return mean_square(draw_errors_of_lights(mesh, *transport, problem, standard_error)).sqrt();
  };
  const Field of_one = errors_of_lights(Eigen::Array3d(2, 0, 0));
  EXPECT_NEAR(of_one(0), 2, single_precision);
  EXPECT_NEAR(of_one(1), 0, single_precision);
  EXPECT_NEAR(of_one(2), 0.5 * 0.3 * 2, single_precision);
  const Field of_both = errors_of_lights(Eigen::Array3d(2, 1, 0));
  EXPECT_GT(of_both(2), 0.2);
  EXPECT_LT(of_both(2), 0.4);
}

// Theorem: the sources' shares of the noise add up to the noise that all receivers expect. With random signs of D_ij,
// sum_i w_i E (D B)_i^2 = sum_i w_i sum_j D_ij^2 B_j^2, and D is symmetric.
TEST(NoiseOfParents, SumsUpToWhatReceiversExpect) {
  const Scene scene = test::furnished_room(0.5);
  const Simulation simulation = simulate(scene, with_bars(300));
  NestedMesh mesh;
  mesh.patches = mesh.parents = simulation.mesh;
  for (PatchIndex i = 0; i <= simulation.mesh.size(); ++i) mesh.first_patch.push_back(i);
  mesh.parent.assign(mesh.first_patch.begin(), mesh.first_patch.end() - 1);
  const Assembly raw = assemble_exchange_areas(simulation.mesh, Occluder(scene), {.keep_errors = true});
  const RadiosityProblem& problem = simulation.problem;
  const Eigen::VectorXd weight = Eigen::VectorXd::LinSpaced(problem.area.size(), 0, 1);
  const Eigen::VectorXd noise = noise_of_parents(raw.half_differences, mesh, {problem, simulation.solution}, weight);

  const Field& B = simulation.solution.radiosity;
  const Field expected = by_variances(raw.half_differences, B.square());
  const Eigen::ArrayXd reflected = area_norm(B - problem.exitance, problem.area).square();
  const Eigen::ArrayXd w = weight.array().square() / problem.area.array();
  double sum = 0;
  for (Eigen::Index band = 0; band < B.cols(); ++band)
    sum += (w * problem.scattering.reflectance.col(band).square() * expected.col(band)).sum() / reflected[band];
  EXPECT_GT(sum, 0);
  EXPECT_NEAR(noise.sum() / sum, 1, 1e-12);
}

// Everything is linear in the light.
TEST(ErrorBars, ScaleWithTheLight) {
  const Simulation one = simulate(test::furnished_room(0.5, 10), with_bars(400));
  const Simulation bright = simulate(test::furnished_room(0.5, 80), with_bars(400));
  // Eight is a power of two, so the bits are the same.
  EXPECT_TRUE((bright.error_bars->mesh == 8 * one.error_bars->mesh).all());
  EXPECT_TRUE((bright.error_bars->form_factor == 8 * one.error_bars->form_factor).all());
  EXPECT_EQ(bright.accuracy[0].total, one.accuracy[0].total);
}

}  // namespace
}  // namespace patchlight::error_bars_test
