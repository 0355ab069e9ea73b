#pragma once

#include "patchlight/simulate.h"

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A solver in a comparison.
struct Contestant {
  Solver solver = Solver::cg;
  Storage storage = Storage::tiles;  ///< of the form factors that it runs on; rows on demand are not closed
};

/// "cg", "progressive-on-demand".
std::string name_of(const Contestant& contestant);

/// All solvers on the stored matrix, and progressive refinement on demand.
std::vector<Contestant> all_contestants();

/// Which solvers are compared, and how far they run.
struct CompareOptions {
  std::vector<Contestant> contestants = all_contestants();
  double relative_error = 1e-6;  ///< true error that every solver is to reach
  int max_iterations = 10000;    ///< after which a solver gives up; one on demand shoots as often as there are patches
  std::optional<double> relaxation = {};  ///< of SOR; without it estimated
  bool keep_iterates = true;              ///< fill SolverRun::frames
};

/// An iterate that was kept.
struct Frame {
  Iteration iteration;
  Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> irradiance;  ///< H_k, W/m^2; B_k = E + rho o H_k
};

/// The result of one solver.
struct SolverRun {
  Contestant contestant;
  Solution solution;
  double seconds = 0;           ///< wall time of the solver; on demand with the rows that it asked for
  double cpu_seconds = 0;       ///< the same, all threads
  double assembly_seconds = 0;  ///< wall time before it could begin: form factors and closure
  double rate = 0;  ///< factor by which the error falls in an iteration, late in the run. An iteration of shooting
                    ///< solvers has as many shots as there are patches. NaN with too few iterations
  std::vector<Frame> frames;  ///< about forty, more at the beginning
};

/// All solvers on one matrix.
struct Comparison {
  Simulation simulation;             ///< with the reference as its solution
  double reference_residual = 0;     ///< relative residual of the reference
  double spectral_radius = 0;        ///< of K, the worst band: the rate that Jacobi should have
  double spectral_radius_error = 0;  ///< of it; its digits below this are not known
  std::vector<SolverRun> runs;
};

/// \throws InputError if settings of the request or of the solvers contradict each other. Messages name the options by
/// their fields, e.g. "compare.contestants".
void check(const Request& request, const CompareOptions& options);

/// Assembles a scene once and solves it with conjugate gradients to 1e-4 of the requested error, as the reference. Then
/// runs every solver from the lamps until its true error, ||B_ref - B_k||_A / ||B_ref - E||_A in the worst band, is
/// small enough. \throws InputError, MemoryError, Canceled.
Comparison compare(const Scene& scene, const Request& request, const CompareOptions& options,
                   const Observer& observer = {});

}  // namespace patchlight
