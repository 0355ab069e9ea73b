#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/solve/solve.h"

#include "solve/bounds.h"

#include <Eigen/Core>
#include <functional>
#include <limits>

namespace patchlight {

/// Estimate of F from the rows computed so far: where the light of groups of patches arrives. Consecutive patches form
/// a group, as they are mostly neighbors. There are at most 64 groups, so memory is proportional to the number of
/// patches. It serves the display and the order of shots; it does not change the solution.
class CoarseTransport {
 public:
  explicit CoarseTransport(const RadiosityProblem& problem);

  /// Adds the irradiance `arriving` at all patches due to the radiosity `shot_radiosity` of the patch `source`.
  /// `arriving` has one row per patch, `shot_radiosity` has one row.
  void learn(Eigen::Index source, const Field& shot_radiosity, const Field& arriving);

  /// The patch that shoots next, given the radiosity still to be shot, W/m^2: the one with the most flux, summed over
  /// the bands. First, each group with such flux shoots once, in order of decreasing flux.
  Eigen::Index next_source(const Field& waiting) const;

  /// The irradiance that the unshot radiosity and all its reflections will add, one row per patch. The light of a group
  /// is distributed like that of its known rows, plus a uniform part with the weight of one more row. The lost fraction
  /// equals that of all light so far. 0 in bands where this light is never lost.
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
  Field irradiance;  ///< F B_k; for shooting solvers, the irradiance due to the shots so far
  Field residual;    ///< r, where ||B* - B_k||_A <= ||r||_A / (1 - kappa)
};

/// B_k with the residual E + rho o H - B_k, H = F B_k.
Iterate iterate_of(const RadiosityProblem& problem, Field radiosity, Field irradiance);

/// An iterate that is computed on first use.
using MakeIterate = std::function<Iterate()>;

/// Whether residuals are recomputed from an application or updated by recurrences, which drift.
enum class Residual { applied, recurred };

/// The common part of the iterations of one run: applies the transport, counts applications, measures iterates, keeps
/// the history and decides when to stop. The exitance of the problem is the source, E + rho o H_direct. Its
/// direct_irradiance gives the part that is not emitted by patches.
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

  /// Notifies the observer between two iterates, at most ten times a second. \throws Canceled, like record(), unless
  /// SolverOptions::keeps_unfinished.
  void keep_observer();

  /// Adds E to the history, with F E as computed from the lamps. Returns true if E is accurate enough.
  bool start(Field direct_irradiance);
  /// Adds the next iterate to the history. Returns true if it is accurate enough. Before it returns true for an iterate
  /// with a recurred residual, it recomputes the residual by an application. `number` is the number of the iteration.
  bool record(Iterate iterate, int number, Residual residual = Residual::applied);
  /// The same for an iterate with a recurred residual of known norm ||r||_A, per band. `make` computes the iterate when
  /// more than the norm is needed, and at the end. It must stay valid until then, or until another computed iterate is
  /// recorded.
  bool record(const Eigen::ArrayXd& residual_norm, MakeIterate make, int number);
  /// Sets data for the display of the next iterate: Solution::ambient, and the arrived irradiance where it differs from
  /// (B - E) / rho.
  void show(Field ambient) { ambient_ = std::move(ambient); }
  void show_irradiance(Field arrived) { arrived_ = std::move(arrived); }

  const Field& direct_irradiance() const { return solution_.direct_irradiance; }
  /// True if the iterations are over: the last iterate is accurate enough, the residual is not finite or has reached
  /// rounding, or the observer has stopped the run.
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

/// Gauss-Seidel: every patch gathers with the newest values of the patches before it. The sums of the next sweep give
/// the residual of an iterate, without another application.
Solution gauss_seidel(Iterations iterations, const RowTransport& transport);

/// Successive over-relaxation: Gauss-Seidel with its changes multiplied by options.relaxation, or by
/// relaxation_for(spectral_radius()) of the worst band.
Solution sor(Iterations iterations, const RowTransport& transport);

/// Gauss-Seidel from the first patch to the last and back.
Solution symmetric_gauss_seidel(Iterations iterations, const RowTransport& transport);

/// Chebyshev's semi-iteration for eigenvalues of K between -kappa and kappa, kappa the bound of
/// docs/theory/solvers-and-bounds.md below 1, else the spectral radius.
Solution chebyshev(Iterations iterations);

/// The relaxation factor for a matrix with one eigenvalue `radius` < 1 far above all others: this mode and the rest
/// decay at the same rate. docs/theory/solvers-and-bounds.md.
double relaxation_for(double radius);

// Krylov methods, all bands at once, with separate scalars per band. F times each direction is stored, which gives the
// irradiance and the residual of the iterates without further applications, also at patches that reflect nothing. They
// are written here because library routines take one band at a time and hide their iterates.

/// Conjugate gradients (Hestenes and Stiefel 1952) on the symmetric system (I - G) w = R^1/2 A^-1/2 S E. Here B = E +
/// R^1/2 A^-1/2 w and G = R^1/2 A^-1/2 S A^-1/2 R^1/2. docs/theory/solvers-and-bounds.md.
Solution cg(Iterations iterations);

/// Conjugate gradients with the constant mode deflated (Saad, Yeung, Erhel and Guyomarc'h 2000, algorithm 3.6). This
/// costs one more application and removes the effect of the largest eigenvalue.
Solution deflated_cg(Iterations iterations);

/// GMRES with options.restart directions (Saad and Schultz 1986), minimizing ||r||_A.
Solution gmres(Iterations iterations);

/// BiCGSTAB (van der Vorst 1992); two applications an iteration.
Solution bicgstab(Iterations iterations);

/// A loose solution of a problem in which all patches emit 1, by conjugate gradients until no residual exceeds 1/2.
struct GlowingRadiosity {
  Field radiosity;
  int applications = 0;
};
GlowingRadiosity glowing_radiosity(const TransportOperator& transport, const RadiosityProblem& problem,
                                   int max_iterations);

}  // namespace patchlight
