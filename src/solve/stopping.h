#pragma once

#include "patchlight/solve/solve.h"

#include <Eigen/Core>

namespace patchlight {

/// Measures residuals of one problem and keeps the history.
class Stopping {
 public:
  /// Costs one operator application, for the largest row sum.
  Stopping(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options);

  /// The next row of the history, for the radiosity and irradiance of `iterate`. `residual` r = E + K B - B, one row
  /// per patch; `work` in operator applications. \throws Cancelled when the observer says so.
  Iteration measure(const Solution& iterate, const FieldView& residual, double work, const Observer& observer);

  /// True when this is good enough.
  bool reached(const Iteration& iteration) const;

 private:
  const RadiosityProblem& problem_;
  SolverOptions options_;
  Eigen::ArrayXd contraction_;     // per band, bound on ||K||_A
  Eigen::ArrayXd first_residual_;  // ||K E||_A per band, set by the first call
  int number_ = 0;
  double start_;
};

}  // namespace patchlight
