#pragma once

#include "patchlight/base/field.h"

#include <functional>
#include <limits>

namespace patchlight {

/// The stages of a run, in order.
enum class Stage {
  read,
  plan,
  mesh,
  form_factors,
  closure,
  direct_light,
  solve,
  error_bars,
  gather,
  trace_paths,
  render,
  write
};

/// The stage's name as users see it.
const char* name_of(Stage stage);

/// One row of a solver's history.
struct Iteration {
  int number = 0;                ///< 0 is the starting value, the source E + rho o H_direct; the number of
                                 ///< shots in solvers that shoot
  double relative_residual = 0;  ///< ||r||_A / ||K E||_A, worst band
  double error_bound = 0;        ///< bound on ||B - B_k||_A / ||B_k - E||_A, worst band; infinite when none is known
  double seconds = 0;            ///< wall time since the solver started
  double work = 0;               ///< operator applications so far; N shots or N rows count as one
  double true_error = std::numeric_limits<double>::quiet_NaN();  ///< against SolverOptions::reference, worst band
};

/// The state of a run that an observer receives.
struct Progress {
  Stage stage = Stage::read;
  double fraction = 0;                     ///< of this stage, 0 to 1
  const Iteration* iteration = nullptr;    ///< in Stage::solve, with each new iterate
  std::function<Field()> irradiance = {};  ///< with `iteration`: computes H_k, W/m^2, of the iterate B_k = E + rho o
                                           ///< H_k; 0 at first. Valid until the observer returns
  const Field* ambient = nullptr;          ///< with `iteration` of progressive refinement: its Solution::ambient
};

/// Called during a stage, about ten times a second where its work is divided finely enough, and never from two threads
/// at once. Returning false stops the run, which then throws Canceled.
using Observer = std::function<bool(const Progress&)>;

}  // namespace patchlight
