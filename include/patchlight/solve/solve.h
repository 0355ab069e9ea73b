#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

#include <optional>
#include <vector>

namespace patchlight {

/// docs/theory/solvers-and-bounds.md has a paragraph on each.
enum class Solver {
  jacobi,
  gauss_seidel,
  sor,
  symmetric_gauss_seidel,
  chebyshev,
  progressive,
  overshooting,
  cg,
  deflated_cg,
  gmres,
  bicgstab
};

/// All of them, in this order.
std::vector<Solver> all_solvers();

/// The solver's name as on the command line.
const char* name_of(Solver solver);

/// True for the two shooting solvers: they take single rows of the transport, never all at once.
bool is_shooting(Solver solver);

/// True for solvers that sweep or shoot: they need a RowTransport. The others only need H = F B.
bool takes_rows(Solver solver);

/// True for solvers that need a reciprocal transport, A_i F_ij = A_j F_ji: conjugate gradients.
bool takes_reciprocity(Solver solver);

/// True for solvers that need a diagonal R, without translucent sheets: all but GMRES, BiCGSTAB and Jacobi iteration.
bool takes_diagonal(Solver solver);

/// The default solver: conjugate gradients, or GMRES if form factors are not reciprocal or R is not diagonal.
Solver usual_solver(const TransportOperator& transport, const RadiosityProblem& problem);

/// The default relative error of the solver.
inline constexpr double default_tolerance = 1e-6;

/// The solver and its stopping criteria.
struct SolverOptions {
  Solver solver = Solver::cg;
  std::optional<double> relative_error = {};   ///< stop when the bound on ||B - B_k||_A / ||B_k - E||_A is below; left
                                               ///< open default_tolerance
  int max_iterations = 1000;                   ///< for progressive refinement one iteration is as many shots as there
                                               ///< are patches
  std::optional<double> max_rows = {};         ///< progressive refinement stops after so many rows of F, as a share of
                                               ///< the patches; the lamps' are among them, and always taken
  std::optional<double> relaxation = {};       ///< of SOR, above 0 and below 2; without it estimated
  int restart = 30;                            ///< directions that GMRES keeps
  std::optional<double> largest_row_sum = {};  ///< of F, where it is known: saves an application. Infinite: not to be
                                               ///< found, so that there is no bound
  std::optional<Field> reference = {};  ///< a solution to be met, radiosity in W/m^2 of all bands: stop when ||B_ref -
                                        ///< B_k||_A / ||B_ref - E||_A, worst band, is below relative_error
  bool patch_bounds = true;             ///< bound every patch also where kappa is below 1: more applications
  bool every_band = false;              ///< solve bands that follow from others, too
  bool keeps_unfinished = false;        ///< an observer that returns false ends the iterations with the last iterate,
                                        ///< Solution::stopped, instead of throwing Canceled
};

/// The relative error at which a solver with these options stops.
inline double tolerance_of(const SolverOptions& options) { return options.relative_error.value_or(default_tolerance); }

/// Solves B = E + R F B. Bands without light are not solved. Bands with equal reflectances whose lamps differ by a
/// factor are solved once, unless SolverOptions::every_band.
///
/// The stopping criterion is the first of these that is known, see docs/theory/solvers-and-bounds.md:
/// - the bound ||r||_A / (1 - kappa), kappa = rho_max times the largest row sum of F, if kappa < 1;
/// - the bound of every patch,
/// - the relative residual, with an infinite error_bound in the history.
/// Without convergence it returns after max_iterations with converged = false and its history. For a singular system it
/// returns at once, with Solution::trapped, unless the largest row sum is infinite.
///
/// A transport that is not reciprocal has no kappa; the bound of every patch applies. \throws Canceled; InputError,
/// before any work, if takes_rows() and the transport is no RowTransport, if takes_reciprocity() and the transport is
/// not reciprocal, or if takes_diagonal() and there are sheets.
Solution solve(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options = {},
               const Observer& observer = {});

}  // namespace patchlight
