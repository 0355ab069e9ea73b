#pragma once

#include "patchlight/solve/solve.h"

#include "solve/bounds.h"

#include <Eigen/Core>
#include <functional>
#include <limits>

namespace patchlight {

/// One step of a solver.
struct Iterate {
  Field radiosity;   ///< B_k
  Field irradiance;  ///< F B_k; for what shoots, the irradiance by what has been shot
  Field residual;    ///< r, where ||B* - B_k||_A <= ||r||_A / (1 - kappa)
};

/// B_k with the residual E + rho o H - B_k, H = F B_k.
Iterate iterate_of(const RadiosityProblem& problem, Field radiosity, Field irradiance);

/// One that is made when it is looked at.
using MakeIterate = std::function<Iterate()>;

/// Whether residuals are computed anew from an application, or are carried along by recurrences, which drift.
enum class Residual { applied, recurred };

/// What the iterations of one run have in common. The problem's exitance is the source, E + rho o H_direct; its
/// direct_irradiance tells how much of that is no patch's own light. Applies the transport and counts, measures
/// iterates, keeps the history, tells when to stop.
class Iterations {
 public:
  Iterations(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
             const Observer& observer);

  const RadiosityProblem& problem() const { return problem_; }
  const SolverOptions& options() const { return options_; }
  const Bounds& bounds() const { return bounds_; }

  /// F B; counts as one application.
  Field apply(const FieldView& radiosity);
  /// The spectral radius of K per band; counts its applications.
  Eigen::ArrayXd spectral_radius(int steps);
  /// Counts work that was done otherwise, in applications.
  void count(double applications) { work_ += applications; }

  /// Lets the observer know between two iterates, at most ten times a second. \throws Cancelled, as record(), unless
  /// SolverOptions::keeps_unfinished.
  void keep_observer();

  /// Puts E into the history, with F E as it is found from the lamps. True when that is good enough.
  bool start(Field direct_irradiance);
  /// Puts the next iterate into the history. True when it is good enough; one with a recurred residual is measured once
  /// more, by an application, before that is said. `number` is the iteration's.
  bool record(Iterate iterate, int number, Residual residual = Residual::applied);
  /// The same for one with a recurred residual of which ||r||_A is known, per band. The iterate is made where something
  /// else is to be known of it, and in the end: `make` has to be good until then, or until one that is made is
  /// recorded.
  bool record(const Eigen::ArrayXd& residual_norm, MakeIterate make, int number);
  /// What goes with the next iterate for display: Solution::ambient, and the irradiance that has arrived, where it is
  /// not (B - E) / rho.
  void show(Field ambient) { ambient_ = std::move(ambient); }
  void show_irradiance(Field arrived) { arrived_ = std::move(arrived); }

  const Field& direct_irradiance() const { return solution_.direct_irradiance; }
  /// True when there is nothing more to do: the last iterate was good enough, or no further one will be better: the
  /// residual is not finite any more, or has come down to rounding; or the observer has stopped the run.
  bool ended() const { return solution_.converged || hopeless_ || solution_.stopped; }
  /// B = E + rho o H with the H of the last iterate.
  Solution finish();

 private:
  Iteration measured(const Iterate& iterate, int number) const;
  Iteration measured(const Eigen::ArrayXd& residual_norm, int number) const;
  bool needs_norm_only() const;
  bool put_into_history(const Iteration& iteration);
  bool is_good(const Iteration& iteration) const;
  bool wants_weights() const;
  void tell(const std::function<Field()>& irradiance);
  void stop();

  const TransportOperator& transport_;
  const RadiosityProblem& problem_;
  const SolverOptions& options_;
  const Observer& observer_;
  Field emitted_;  // E
  Bounds bounds_;
  double start_;
  double work_ = 0;
  double fraction_ = 0;
  double next_report_ = 0;
  Eigen::ArrayXd first_residual_;
  double last_applied_residual_ = std::numeric_limits<double>::infinity();
  double least_residual_ = std::numeric_limits<double>::infinity();
  int without_progress_ = 0;  // iterates since it was found
  bool hopeless_ = false;
  Iterate last_;
  MakeIterate make_last_;  // what is to be called for it, where it is not made yet
  Field ambient_, arrived_;
  Solution solution_;
};

}  // namespace patchlight
