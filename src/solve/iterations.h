#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/solve/solve.h"

#include "solve/bounds.h"

#include <Eigen/Core>
#include <functional>
#include <limits>

namespace patchlight {

/// What the rows of F that have been taken so far tell about all of it: where the light of groups of patches arrives.
/// Patches that follow each other make a group, as they mostly lie side by side; there are at most 64, so that memory
/// stays in proportion to the patches. For display and for the order of shots: nothing here changes a solution.
class CoarseTransport {
 public:
  explicit CoarseTransport(const RadiosityProblem& problem);

  /// The irradiance everywhere, `arriving`, by the radiosity `shot_radiosity` of one patch; one row per patch, and one
  /// row.
  void learn(Eigen::Index source, const Field& shot_radiosity, const Field& arriving);

  /// The patch that shoots next when `waiting` is to be shot, W/m^2: the one with the most flux, summed over the bands.
  /// Before that, each group that has any shoots once, the one with the most flux first.
  Eigen::Index next_source(const Field& waiting) const;

  /// The irradiance that unshot radiosity and all its reflections are going to add, one row per patch. A group's light
  /// is taken to arrive where that of its known rows does, and evenly everywhere to the weight of one more row; as much
  /// of that gets lost as of all light so far. 0 in bands where by this light is never lost.
  Field ambient(const Field& unshot) const;

 private:
  Eigen::Index group_of(Eigen::Index patch) const { return patch * groups_ / patches_; }

  const RadiosityProblem& problem_;
  Eigen::Index patches_;
  Eigen::Index groups_;
  Eigen::MatrixXf arriving_;  // at each patch (row) from each group (column), by unit radiosity of its known patches
  Eigen::VectorXd arrived_;   // its flux, m^2
  Eigen::VectorXd area_;      // of the known patches, m^2
};

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

/// Jacobi iteration B <- E + K B: iteration k adds bounce k (the Neumann series).
Solution jacobi(Iterations iterations);

/// Gauss-Seidel: every patch gathers with the newest values of the patches before it. The residual of an iterate is had
/// from the sums of the next sweep, which costs no further application.
Solution gauss_seidel(Iterations iterations, const RowTransport& transport);

/// Successive over-relaxation: Gauss-Seidel with its changes multiplied by options.relaxation, or by
/// relaxation_for(spectral_radius()) of the worst band.
Solution sor(Iterations iterations, const RowTransport& transport);

/// Gauss-Seidel from the first patch to the last and back.
Solution symmetric_gauss_seidel(Iterations iterations, const RowTransport& transport);

/// Chebyshev's semi-iteration for eigenvalues of K between -kappa and kappa, kappa the bound of
/// docs/theory/solvers-and-bounds.md below 1, else the spectral radius.
Solution chebyshev(Iterations iterations);

/// A relaxation factor for matrices whose spectrum is one mode with the eigenvalue `radius` < 1 far above all others:
/// where the mode and the rest decay alike. docs/theory/solvers-and-bounds.md.
double relaxation_for(double radius);

// Krylov methods, all bands at once with scalars of their own. Every direction goes with its F times it, so that the
// irradiance of the iterates, and with it their residual, is had without further applications, also at patches that
// reflect nothing. Written here because library routines take one band at a time and hide their iterates.

/// Conjugate gradients (Hestenes and Stiefel 1952) on the symmetric system (I - G) w = R^1/2 A^-1/2 S E with
/// B = E + R^1/2 A^-1/2 w and G = R^1/2 A^-1/2 S A^-1/2 R^1/2. docs/theory/solvers-and-bounds.md.
Solution cg(Iterations iterations);

/// The same with the mode deflated that is constant irradiance (Saad, Yeung, Erhel and Guyomarc'h 2000, algorithm 3.6):
/// one application more, and the largest eigenvalue no longer counts.
Solution deflated_cg(Iterations iterations);

/// GMRES with options.restart directions (Saad and Schultz 1986), minimising ||r||_A.
Solution gmres(Iterations iterations);

/// BiCGSTAB (van der Vorst 1992); two applications an iteration.
Solution bicgstab(Iterations iterations);

/// A loose solution for a problem of which all patches emit 1: by conjugate gradients until no residual is above 1/2.
struct GlowingRadiosity {
  Field radiosity;
  int applications = 0;
};
GlowingRadiosity glowing_radiosity(const TransportOperator& transport, const RadiosityProblem& problem,
                                   int max_iterations);

}  // namespace patchlight
