#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

#include <string>
#include <vector>

namespace patchlight {

enum class Solver { jacobi, gauss_seidel, progressive };

/// The solver's name as on the command line.
const char* name_of(Solver solver);

struct SolverOptions {
  Solver solver = Solver::gauss_seidel;
  double relative_error = 1e-6;  ///< stop when the bound on ||B - B_k||_A / ||B_k - E||_A is below
  int max_iterations = 1000;     ///< for progressive refinement one iteration is as many shots as there are patches
};

/// Solves B = E + rho o F B for all bands at once. Stops by the bound ||r||_A / (1 - kappa), kappa = rho_max times the
/// largest row sum of F, of docs/theory.md section 7. Where kappa is not below 1 there is no bound: the relative
/// residual decides instead, and the history's error_bound is infinite. What cannot converge ends after max_iterations
/// with converged = false and its history. \throws Cancelled.
Solution solve(const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions& options = {},
               const Observer& observer = {});

}  // namespace patchlight
