#include "pipeline/solve_for_interest.h"

#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "pipeline/relative_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// Asked for so much less than is needed, as the bound of a patch does not fall evenly with the residual.
constexpr double bar_margin = 0.5;

// In one step no farther than this.
constexpr double farthest = 1e-4;

// Nearer than this to rounding no solver gets.
constexpr double least_error = 1e-12;

}  // namespace

SolvedWith solve_for_interest(const Run& run, const Simulation& simulation, const SolverOptions& by,
                              const Solve& solve) {
  SolverOptions options = by;
  SolvedWith best{solve(options), tolerance_of(options)};
  const std::optional<double>& part = simulation.plan.accuracy.solver_part;
  if (!part || !best.solution.converged) return best;
  const Eigen::VectorXd interest = interest_in(run.scene, simulation);
  for (;;) {
    const SolvedProblem solved{simulation.problem, best.solution};
    const double left = relative_bar(solver_errors(solved), simulation.problem, best.solution, interest);
    // What is infinite has no bound, or no light: no tolerance mends that.
    if (!(left > *part) || !std::isfinite(left) || best.relative_error <= least_error) return best;
    options.relative_error = std::max(least_error, best.relative_error * std::max(farthest, bar_margin * *part / left));
    Solution next = solve(options);
    if (!next.converged) return best;
    best = {std::move(next), tolerance_of(options)};
  }
}

}  // namespace patchlight
