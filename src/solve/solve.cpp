#include "patchlight/solve/solve.h"

#include "patchlight/base/error.h"

#include "base/vectors.h"
#include "solve/iterations.h"
#include "solve/krylov.h"
#include "solve/pocket_transport.h"
#include "solve/relaxation.h"
#include "solve/scattering.h"
#include "solve/solved_bands.h"
#include "solve/southwell.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// `rows` is null where the solver takes none.
Solution solution_by(Solver solver, Iterations iterations, const RowTransport* rows) {
  switch (solver) {
    case Solver::jacobi:
      return jacobi(std::move(iterations));
    case Solver::gauss_seidel:
      return gauss_seidel(std::move(iterations), *rows);
    case Solver::sor:
      return sor(std::move(iterations), *rows);
    case Solver::symmetric_gauss_seidel:
      return symmetric_gauss_seidel(std::move(iterations), *rows);
    case Solver::chebyshev:
      return chebyshev(std::move(iterations));
    case Solver::progressive:
      return progressive_refinement(std::move(iterations), *rows, Shot::unshot);
    case Solver::overshooting:
      return progressive_refinement(std::move(iterations), *rows, Shot::overshot);
    case Solver::cg:
      return cg(std::move(iterations));
    case Solver::deflated_cg:
      return deflated_cg(std::move(iterations));
    case Solver::gmres:
      return gmres(std::move(iterations));
    case Solver::bicgstab:
      return bicgstab(std::move(iterations));
  }
  assert(false);
  return {};
}

// The field, and the light that comes from no patch.
Field with_direct(Field irradiance, const RadiosityProblem& problem) {
  if (problem.direct_irradiance.size() > 0) irradiance += problem.direct_irradiance;
  return irradiance;
}

// The transport with single rows, if it has them.
const RowTransport* rows_of(const TransportOperator& transport, Solver solver) {
  const auto* const rows = dynamic_cast<const RowTransport*>(&transport);
  if (rows == nullptr && takes_rows(solver)) {
    throw InputError(name_of(solver),
                     "takes single rows of the form factors, which cannot be had as they are kept here; expected a "
                     "solver that takes none, as " +
                         std::string(transport.is_reciprocal() ? "cg" : "gmres"));
  }
  return rows;
}

// Conjugate gradients rest on A_i F_ij = A_j F_ji.
void require_reciprocity(const TransportOperator& transport, Solver solver) {
  if (transport.is_reciprocal() || !takes_reciprocity(solver)) return;
  throw InputError(name_of(solver),
                   "takes form factors that are reciprocal, A_i F_ij = A_j F_ji, which rows of rays are but for their "
                   "errors; expected gmres, bicgstab, jacobi or chebyshev");
}

// What sheets scatter depends on both sides.
void require_diagonal(const Scattering& scattering, Solver solver) {
  if (scattering.is_diagonal() || !takes_diagonal(solver)) return;
  throw InputError(name_of(solver),
                   "takes patches that scatter each by itself, which the sides of translucent sheets do not; expected "
                   "gmres, bicgstab or jacobi");
}

// F E, where there are rows from those of the lamps alone.
Field from_lamps(const TransportOperator& transport, const RowTransport* rows, const Field& exitance) {
  if ((exitance == 0).all()) return Field::Zero(exitance.rows(), exitance.cols());
  if (rows == nullptr) return transport.apply(exitance);
  Field irradiance = Field::Zero(exitance.rows(), exitance.cols());
  for (Eigen::Index i = 0; i < exitance.rows(); ++i) {
    if (!(exitance.row(i) > 0).any()) continue;
    const auto index = static_cast<PatchIndex>(i);
    irradiance += rows->shoot({index, index + 1}, exitance.row(i));
  }
  return irradiance;
}

// The light of the lamps, and nothing more: for a system without a solution.
Solution lamps_alone(const TransportOperator& transport, const RadiosityProblem& problem, std::string why) {
  Solution solution;
  solution.radiosity = problem.exitance;
  solution.direct_irradiance = transport.apply(problem.exitance);
  solution.irradiance = solution.direct_irradiance;
  solution.trapped = std::move(why);
  const double unknown = std::numeric_limits<double>::infinity();
  solution.history.push_back({.number = 0, .relative_residual = 1, .error_bound = unknown, .seconds = 0, .work = 1});
  return solution;
}

// The pockets of a transport, where they are known.
const Pockets* pockets_in(const TransportOperator& transport, const Scattering& scattering) {
  const auto* const rays = dynamic_cast<const RaysWithPockets*>(&transport);
  const bool may_be_known = rays != nullptr && scattering.is_diagonal();
  return may_be_known ? rays->pockets(scattering.reflectance.rowwise().maxCoeff()) : nullptr;
}

// What the patches of pockets send to each other at first arrives at them as direct irradiance does.
Solution solved_around(const TransportOperator& transport, const Pockets& pockets, bool closed_are_dark,
                       RadiosityProblem problem, const SolverOptions& options, const Observer& observer) {
  constexpr double share_of_tolerance = 0.01;
  constexpr double least = 1e-9;  // of what rounding leaves of light that is reflected thousands of times
  const double accuracy = std::max(least, share_of_tolerance * tolerance_of(options));
  const PocketTransport around(transport, pockets, problem.scattering, closed_are_dark, accuracy);
  const Field within = around.irradiance_within(problem.exitance);
  const Field by_lamps = transport.apply(problem.exitance);
  if (problem.direct_irradiance.size() == 0) problem.direct_irradiance = Field::Zero(within.rows(), within.cols());
  problem.direct_irradiance += within;
  problem.exitance = plus_reflected(std::move(problem.exitance), problem.scattering, within);
  Observer of_all;
  if (observer) {
    of_all = [&](const Progress& progress) {
      if (!progress.irradiance) return observer(progress);
      Progress all = progress;
      all.irradiance = [&] { return Field(progress.irradiance() + within); };
      return observer(all);
    };
  }
  Solution solution = solution_by(options.solver, Iterations(around, problem, options, of_all), nullptr);
  solution.irradiance += within;
  solution.direct_irradiance = by_lamps;
  // No bound has more than what was wanted.
  if (around.farthest_off() > tolerance_of(options)) {
    solution.error.resize(0, 0);
    solution.patch_bound = std::numeric_limits<double>::infinity();
  }
  return solution;
}

// A singular system is said before any iteration: it has lamps on patches that no light leaves, all of which are closed
// pockets where these are known. What shoots does not look at the whole transport.
Solution solution_of(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
                     const Observer& observer) {
  const Pockets* const pockets = pockets_in(transport, problem.scattering);
  const bool closed_are_dark = pockets != nullptr && !(chosen_rows(problem.exitance, pockets->closed) > 0).any();
  const bool known = !options.largest_row_sum || std::isfinite(*options.largest_row_sum);
  std::string trapped = known && !closed_are_dark ? trapped_light(transport, problem) : std::string();
  if (!trapped.empty()) return lamps_alone(transport, problem, std::move(trapped));
  if (pockets != nullptr) return solved_around(transport, *pockets, closed_are_dark, problem, options, observer);
  return solution_by(options.solver, Iterations(transport, problem, options, observer),
                     rows_of(transport, options.solver));
}

}  // namespace

std::vector<Solver> all_solvers() {
  return {Solver::jacobi,      Solver::gauss_seidel, Solver::sor,          Solver::symmetric_gauss_seidel,
          Solver::chebyshev,   Solver::progressive,  Solver::overshooting, Solver::cg,
          Solver::deflated_cg, Solver::gmres,        Solver::bicgstab};
}

const char* name_of(Solver solver) {
  switch (solver) {
    case Solver::jacobi:
      return "jacobi";
    case Solver::gauss_seidel:
      return "gauss-seidel";
    case Solver::sor:
      return "sor";
    case Solver::symmetric_gauss_seidel:
      return "symmetric-gauss-seidel";
    case Solver::chebyshev:
      return "chebyshev";
    case Solver::progressive:
      return "progressive";
    case Solver::overshooting:
      return "overshooting";
    case Solver::cg:
      return "cg";
    case Solver::deflated_cg:
      return "deflated-cg";
    case Solver::gmres:
      return "gmres";
    case Solver::bicgstab:
      return "bicgstab";
  }
  return "";
}

bool takes_rows(Solver solver) {
  return is_shooting(solver) || solver == Solver::gauss_seidel || solver == Solver::sor ||
         solver == Solver::symmetric_gauss_seidel;
}

bool takes_reciprocity(Solver solver) { return solver == Solver::cg || solver == Solver::deflated_cg; }

bool takes_diagonal(Solver solver) {
  return takes_rows(solver) || takes_reciprocity(solver) || solver == Solver::chebyshev;
}

Solver usual_solver(const TransportOperator& transport, const RadiosityProblem& problem) {
  return transport.is_reciprocal() && problem.scattering.is_diagonal() ? Solver::cg : Solver::gmres;
}

bool is_shooting(Solver solver) { return solver == Solver::progressive || solver == Solver::overshooting; }

Eigen::ArrayXd area_norm(const FieldView& x, const Eigen::VectorXd& area) { return inner_product(x, x, area).sqrt(); }

double relative_error(const FieldView& reference, const FieldView& radiosity, const RadiosityProblem& problem) {
  const Eigen::ArrayXd error = area_norm(reference - radiosity, problem.area);
  const Eigen::ArrayXd size = area_norm(reference - problem.exitance, problem.area);
  constexpr double rounding = 1e-14;
  const Eigen::ArrayXd rounded = rounding * area_norm(reference, problem.area);
  double worst = 0;
  for (Eigen::Index band = 0; band < error.size(); ++band) {
    // 0 / 0 is 0, but for rounding: nothing is wrong where there is nothing. What is not a number is worse than any.
    const double of_band = error[band] <= rounded[band] ? 0 : error[band] / size[band];
    if (std::isnan(of_band) || of_band > worst) worst = of_band;
  }
  return worst;
}

Solution solve(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
               const Observer& observer) {
  assert(problem.exitance.rows() == static_cast<Eigen::Index>(transport.size()));
  assert(problem.scattering.reflectance.rows() == problem.exitance.rows() &&
         problem.scattering.reflectance.cols() == problem.exitance.cols());

  const RowTransport* const rows = rows_of(transport, options.solver);
  require_reciprocity(transport, options.solver);
  require_diagonal(problem.scattering, options.solver);

  // 1. Light that comes from no patch is a source where it is first reflected: B = S + rho o F B. Only the bands that
  //    need it.
  const RadiosityProblem with_source{problem.scattering, source_radiosity(problem), problem.area,
                                     problem.direct_irradiance};
  const SolvedBands bands = options.every_band ? all_bands(with_source) : solved_bands(with_source);
  const RadiosityProblem needed{of_bands(with_source.scattering, bands.solved), reduced(with_source.exitance, bands),
                                problem.area, reduced(problem.direct_irradiance, bands)};
  SolverOptions used = options;
  if (options.reference) used.reference = reduced(*options.reference, bands);
  const Observer of_needed = telling_all_bands(observer, bands, &problem.direct_irradiance);

  // 2. The solution of these.
  Solution solution = solution_of(transport, needed, used, of_needed);

  // 3. All bands again, and all of the irradiance.
  for (Field* field :
       {&solution.radiosity, &solution.irradiance, &solution.direct_irradiance, &solution.ambient, &solution.error}) {
    *field = expanded(*field, bands);
  }
  if (problem.direct_irradiance.size() == 0) return solution;
  solution.irradiance += problem.direct_irradiance;
  solution.direct_irradiance = with_direct(from_lamps(transport, rows, problem.exitance), problem);
  return solution;
}

}  // namespace patchlight
