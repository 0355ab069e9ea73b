#include "patchlight/simulate.h"
#include "patchlight/solve/solve.h"

#include "support/scenes.h"

#include <gtest/gtest.h>

namespace patchlight::solved_test {
namespace {

// Iterations may leave dark patches slightly below 0. The lamp keeps the light that it emits.
TEST(Solved, HasNoNegativeLight) {
  const Scene scene = test::furnished_room(0.5);
  Request request;
  request.mesh.patches = 100;
  request.assembly.storage = Storage::tiles;
  const auto solve_below_0 = [](const RowTransport& transport, const RadiosityProblem& problem,
                                const SolverOptions& options, const Observer& observer) {
    Solution solution = solve(transport, problem, options, observer);
    solution.irradiance -= 2 * solution.irradiance.maxCoeff();
    solution.radiosity = problem.exitance + problem.scattering.reflect(solution.irradiance);
    return solution;
  };
  const Simulation simulation = simulate(scene, request, {}, {.solve = solve_below_0});
  EXPECT_TRUE((simulation.solution.irradiance == 0).all());
  EXPECT_TRUE((simulation.solution.radiosity == simulation.problem.exitance).all());
  EXPECT_TRUE((simulation.problem.exitance > 0).any());
}

}  // namespace
}  // namespace patchlight::solved_test
