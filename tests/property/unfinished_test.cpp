// Results of a run that is stopped early.
#include "patchlight/base/error.h"
#include "patchlight/simulate.h"

#include "support/test_room.h"

#include <gtest/gtest.h>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight::unfinished_test {
namespace {

using namespace test;

// Stops the run at the first moment for which `is_due(progress, meshes solved before)`. Returns nothing if no result
// exists by then.
template <class IsDue>
std::optional<Simulation> stopped_run(const Request& request, bool keeps, const IsDue& is_due) {
  bool stopped = false;
  int solved = 0;
  const Observer observer = [&](const Progress& progress) {
    stopped = stopped || is_due(progress, solved);
    return !stopped;
  };
  Steps with;
  if (keeps) with.keeps_unfinished = [] {};
  with.look = [&](const Simulation&) { ++solved; };
  try {
    return simulate(test_room(0.6), request, observer, with);
  } catch (const Canceled&) {
    return std::nullopt;
  }
}

Request accurate(double relative_error) {
  Request request;
  request.mesh.patches = 200;
  request.assembly.storage = Storage::tiles;
  request.accuracy.relative_error = relative_error;
  return request;
}

TEST(Unfinished, IsTheLastMeshWhoseErrorsAreKnown) {
  const auto third_mesh = [](const Progress& p, int solved) { return solved == 2 && p.stage == Stage::form_factors; };
  const std::optional<Simulation> left = stopped_run(accurate(0.002), true, third_mesh);
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->unfinished);
  EXPECT_TRUE(left->solution.converged);
  ASSERT_TRUE(left->error_bars);
  ASSERT_EQ(left->accuracy.size(), 2);
  EXPECT_EQ(left->accuracy.back().patches, left->mesh.size());
  EXPECT_FALSE(left->costs.empty());
}

// The same with local cuts but without an accuracy.
TEST(Unfinished, IsTheFirstMeshWithItsErrorsWhileASecondIsSolved) {
  Request request;
  request.mesh.patches = 500;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  request.accuracy.local_cuts = true;
  const auto second_mesh = [](const Progress& p, int solved) { return solved == 1 && p.stage == Stage::form_factors; };
  const std::optional<Simulation> left = stopped_run(request, true, second_mesh);
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->unfinished);
  EXPECT_TRUE(left->error_bars);
  EXPECT_EQ(left->accuracy.size(), 1U);
}

// The same bits as a run that ends there by itself.
TEST(Unfinished, IsWhatARunThatEndsThereGives) {
  const auto second_mesh = [](const Progress& p, int solved) { return solved == 1 && p.stage == Stage::form_factors; };
  const std::optional<Simulation> left = stopped_run(accurate(0.002), true, second_mesh);
  ASSERT_TRUE(left);
  const Simulation first = simulate(test_room(0.6), [&] {
    Request once = accurate(0.002);
    once.accuracy.relative_error = left->accuracy.back().total * 1.5;
    once.solver.relative_error = tolerance_of(left->plan.solver);
    return once;
  }());
  EXPECT_FALSE(first.unfinished);
  ASSERT_EQ(first.mesh.size(), left->mesh.size());
  EXPECT_TRUE((first.solution.radiosity == left->solution.radiosity).all());
}

TEST(Unfinished, IsTheFirstSolutionWithoutErrorsWhileTheseAreWorkedOut) {
  const auto bars = [](const Progress& p, int solved) { return solved == 0 && p.stage == Stage::error_bars; };
  const std::optional<Simulation> left = stopped_run(accurate(0.002), true, bars);
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->unfinished);
  EXPECT_TRUE(left->solution.converged);
  EXPECT_FALSE(left->error_bars);
  EXPECT_TRUE(left->accuracy.empty());
}

// Progressive refinement approaches the full light from below.
TEST(Unfinished, IsTheLastIterateOfTheSolver) {
  Request request;
  request.mesh.patches = 100;
  request.assembly.storage = Storage::on_demand;
  request.solver.solver = Solver::progressive;
  const auto fifth_shot = [](const Progress& p, int) { return p.iteration != nullptr && p.iteration->number >= 5; };
  const std::optional<Simulation> left = stopped_run(request, true, fifth_shot);
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->unfinished);
  EXPECT_FALSE(left->solution.converged);
  const Simulation whole = simulate(test_room(0.6), request);
  ASSERT_EQ(whole.mesh.size(), left->mesh.size());
  const double rounding = 1e-9 * whole.solution.radiosity.maxCoeff();
  EXPECT_TRUE((left->solution.radiosity <= whole.solution.radiosity + rounding).all());
  EXPECT_LT(left->solution.radiosity.sum(), whole.solution.radiosity.sum());
}

TEST(Unfinished, IsNothingBeforeAnythingIsSolvedOrWhenNothingIsWanted) {
  const auto at_once = [](const Progress& p, int) { return p.stage == Stage::form_factors; };
  EXPECT_FALSE(stopped_run(accurate(0.002), true, at_once));
  const auto later = [](const Progress& p, int solved) { return solved == 1 && p.stage == Stage::form_factors; };
  EXPECT_FALSE(stopped_run(accurate(0.002), false, later));
  // Rows of rays need several solutions, none of which is valid without the others.
  Request by_rays;
  by_rays.mesh.patches = 300;
  by_rays.assembly.storage = Storage::rays;
  by_rays.solver.solver = Solver::gmres;
  EXPECT_FALSE(stopped_run(by_rays, true, [](const Progress& p, int) { return p.iteration != nullptr; }));
}

}  // namespace
}  // namespace patchlight::unfinished_test
