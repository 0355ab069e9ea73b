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
  int number = 0;                ///< 0 is the starting value, the source E + rho o H_direct; of what
                                 ///< shoots, the number of its shots
  double relative_residual = 0;  ///< ||r||_A / ||K E||_A, worst band
  double error_bound = 0;        ///< bound on ||B - B_k||_A / ||B_k - E||_A, worst band; infinite when none is known
  double seconds = 0;            ///< wall time since the solver started
  double work = 0;               ///< operator applications so far; N shots or N rows count as one
  double true_error = std::numeric_limits<double>::quiet_NaN();  ///< against SolverOptions::reference, worst band
};

/// What an observer is told.
struct Progress {
  Stage stage = Stage::read;
  double fraction = 0;                     ///< of this stage, 0 to 1
  const Iteration* iteration = nullptr;    ///< in Stage::solve, with each new iterate
  std::function<Field()> irradiance = {};  ///< goes with it: makes H_k, W/m^2, of the iterate B_k = E + rho o H_k; 0 at
                                           ///< first. To be called before the observer returns
  const Field* ambient = nullptr;  ///< goes with it for progressive refinement: Solution::ambient of this iterate
};

/// Called while a stage goes on, about ten times a second where its work is cut finely enough, never from two threads
/// at once; returning false stops the run, which then throws Cancelled.
using Observer = std::function<bool(const Progress&)>;

}  // namespace patchlight
