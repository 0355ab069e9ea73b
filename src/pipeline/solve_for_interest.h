#pragma once

#include "pipeline/run.h"

#include <functional>

namespace patchlight {

/// Solves with some options.
using Solve = std::function<Solution(const SolverOptions& options)>;

/// A solution and the relative error that was asked of the solver.
struct SolvedWith {
  Solution solution;
  double relative_error = 0;
};

/// The solution by some options, or with a smaller relative error than these ask for until the solver's part of the
/// error of what is of interest is no more than AccuracyOptions::solver_part: a bound on all light together says little
/// about the light in a dim room. Ends with the last one that has converged. `simulation` has the plan, the problem and
/// the mesh.
SolvedWith solve_for_interest(const Run& run, const Simulation& simulation, const SolverOptions& by,
                              const Solve& solve);

}  // namespace patchlight
