#include "patchlight/solve/solve.h"

#include "patchlight/base/error.h"

#include "base/vectors.h"
#include "solve/iterations.h"
#include "solve/pockets.h"
#include "solve/scattering.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

// How much a patch shoots: its unshot radiosity alone, or also its share of the expected light.
enum class Shot { unshot, overshot };

// The share of even irradiance that is reflected.
Eigen::ArrayXd mean_reflectance_of(const RadiosityProblem& problem) {
  const Field reflected = reflect_even(problem.scattering, Eigen::ArrayXd::Ones(problem.exitance.cols()));
  return area_sum(reflected, problem.area) / total(problem.area);
}

// Irradiance that the unshot radiosity would add everywhere if it and all its reflections spread evenly: sum_i A_i dB_i
// / sum_i A_i / (1 - mean rho). Overshooting shoots this light in advance. Cohen et al. 1988, section 3.2.
Eigen::ArrayXd even_irradiance(const Field& unshot, const Eigen::VectorXd& area,
                               const Eigen::ArrayXd& mean_reflectance) {
  const Eigen::ArrayXd mean_unshot = area_sum(unshot, area) / total(area);
  return (mean_reflectance < 1).select(mean_unshot / (1 - mean_reflectance), 0.0);
}

// The irradiance due to the lamps, the number of their patches, and the coarse transport from their rows.
struct Lamps {
  Field irradiance;
  Eigen::Index patches = 0;
  CoarseTransport coarse;
};

// Notifies `iterations` of each row.
Lamps lamps_shot(Iterations& iterations, const RowTransport& transport) {
  const RadiosityProblem& problem = iterations.problem();
  const Field& exitance = problem.exitance;
  Lamps lamps{Field::Zero(exitance.rows(), exitance.cols()), 0, CoarseTransport(problem)};
  for (Eigen::Index i = 0; i < exitance.rows(); ++i) {
    if (!(exitance.row(i) > 0).any()) continue;
    const auto index = static_cast<PatchIndex>(i);
    const Field arriving = transport.shoot({index, index + 1}, exitance.row(i));
    lamps.coarse.learn(i, exitance.row(i), arriving);
    lamps.irradiance += arriving;
    ++lamps.patches;
    iterations.count(1.0 / static_cast<double>(exitance.rows()));
    iterations.keep_observer();
  }
  return lamps;
}

// Factor on the unshot radiosity, per band. Overshooting handles the light that spreads evenly. The factor is the best
// over-relaxation for the next eigenvalue of K (Young 1971). That of F is about 0.7 in box-shaped rooms.
Eigen::ArrayXd over_relaxation(const Eigen::ArrayXd& mean_reflectance) {
  return 2 / (1 + (1 - (0.7 * mean_reflectance).square()).sqrt());
}

// The radiosity to shoot: the unshot radiosity, over-relaxed, plus the reflection of the expected light.
Field with_expected(const Field& unshot, const RadiosityProblem& problem, const Eigen::ArrayXd& mean_reflectance) {
  Field waiting = reflect_even(problem.scattering, even_irradiance(unshot, problem.area, mean_reflectance));
  waiting += unshot.rowwise() * over_relaxation(mean_reflectance).transpose();
  return waiting;
}

// The patch with the most flux to shoot, summed over the bands.
Eigen::Index brightest_patch(const Field& waiting, const Eigen::VectorXd& area) {
  Eigen::Index source = 0;
  (waiting.abs().rowwise().sum() * area.array()).maxCoeff(&source);
  return source;
}

// How many shots there may be after the lamps'.
std::int64_t most_shots(const SolverOptions& options, Eigen::Index patches, Eigen::Index lamps) {
  const std::int64_t most = std::min<std::int64_t>(static_cast<std::int64_t>(options.max_iterations) * patches,
                                                   std::numeric_limits<int>::max());
  if (!options.max_rows) return most;
  const double rows = std::min(*options.max_rows, 1.0 * options.max_iterations + 1) * static_cast<double>(patches);
  return std::clamp<std::int64_t>(static_cast<std::int64_t>(rows) - lamps, 0, most);
}

// Progressive refinement: the lamps shoot first, then repeatedly the patch with the most unshot flux. With a limit of
// rows, SolverOptions::max_rows, a patch of each group of CoarseTransport shoots first, which gives a rough first
// picture everywhere. See Cohen, Chen, Wallace and Greenberg 1988. It is Southwell relaxation of the same system
// (Gortler, Cohen and Slusallek 1994).
// Overshooting (Feda and Purgathofer 1992) shoots the expected light in advance, and over-relaxes the unshot radiosity.
// docs/theory/progressive-refinement.md. Takes single rows of the transport. An iteration has the number of its shots.
Solution progressive_refinement(Iterations iterations, const RowTransport& transport, Shot shot) {
  const RadiosityProblem& problem = iterations.problem();
  const Eigen::Index n = problem.exitance.rows();
  Lamps lamps = lamps_shot(iterations, transport);
  CoarseTransport coarse = std::move(lamps.coarse);
  Field H = lamps.irradiance;
  // With X the radiosity shot so far, B = E + K X: the residual of X, and what B lacks before one reflection, is
  // unshot.
  Field unshot = problem.scattering.reflect(H);
  iterations.show(coarse.ambient(unshot));
  if (iterations.start(std::move(lamps.irradiance))) return iterations.finish();

  const std::int64_t most = most_shots(iterations.options(), n, lamps.patches);
  std::int64_t next_record = 1;
  const Eigen::ArrayXd mean_reflectance = mean_reflectance_of(problem);
  for (std::int64_t shots = 1; shots <= most && !iterations.ended(); ++shots) {
    const Field overshot = shot == Shot::overshot ? with_expected(unshot, problem, mean_reflectance) : Field();
    const Field& waiting = shot == Shot::overshot ? overshot : unshot;
    // A first picture needs the distribution of the light of each group of patches.
    const bool explores = iterations.options().max_rows.has_value();
    const Eigen::Index source = explores ? coarse.next_source(waiting) : brightest_patch(waiting, problem.area);
    const Field shot_radiosity = waiting.row(source);
    // Nothing is left to shoot: this is the solution.
    const bool is_done = (shot_radiosity == 0).all();
    if (is_done) next_record = shots;
    const auto index = static_cast<PatchIndex>(source);
    const Field arriving =
        is_done ? Field::Zero(n, shot_radiosity.cols()) : transport.shoot({index, index + 1}, shot_radiosity);
    unshot.row(source) -= shot_radiosity;
    unshot = plus_reflected(std::move(unshot), problem.scattering, arriving);
    H += arriving;
    coarse.learn(source, shot_radiosity, arriving);
    iterations.count(1.0 / static_cast<double>(n));
    iterations.keep_observer();
    if (shots < next_record && shots < most && !iterations.ended()) continue;
    iterations.show(coarse.ambient(unshot));
    iterations.record({radiosity_from(problem, H), H, unshot}, static_cast<int>(shots));
    // Ever longer pauses, up to an eighth of all patches.
    next_record = shots + std::clamp<std::int64_t>(shots / 10, 1, std::max<Eigen::Index>(1, n / 8));
  }
  return iterations.finish();
}

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

void require_rows(const TransportOperator& transport, Solver solver) {
  if (transport.rows() != nullptr || !takes_rows(solver)) return;
  throw InputError(
      name_of(solver),
      "takes single rows of the form factors, which cannot be had as they are kept here; expected a solver "
      "that takes none, as " +
          std::string(transport.is_reciprocal() ? "cg" : "gmres"));
}

// Conjugate gradients rest on A_i F_ij = A_j F_ji.
void require_reciprocity(const TransportOperator& transport, Solver solver) {
  if (transport.is_reciprocal() || !takes_reciprocity(solver)) return;
  throw InputError(name_of(solver),
                   "takes form factors that are reciprocal, A_i F_ij = A_j F_ji, which rows of rays are but for their "
                   "errors; expected gmres, bicgstab, jacobi or chebyshev");
}

// The scattered light of a sheet depends on both of its sides.
void require_diagonal(const Scattering& scattering, Solver solver) {
  if (scattering.is_diagonal() || !takes_diagonal(solver)) return;
  throw InputError(name_of(solver),
                   "takes patches that scatter each by itself, which the sides of translucent sheets do not; expected "
                   "gmres, bicgstab or jacobi");
}

// In the order of Solver.
constexpr std::array solver_names = {"jacobi",      "gauss-seidel", "sor",          "symmetric-gauss-seidel",
                                     "chebyshev",   "progressive",  "overshooting", "cg",
                                     "deflated-cg", "gmres",        "bicgstab"};
static_assert(solver_names.size() == static_cast<std::size_t>(Solver::bicgstab) + 1);

// The light of the lamps, and nothing more: for a system without a solution.
Solution lamps_alone(const TransportOperator& transport, const RadiosityProblem& problem, std::string why) {
  Solution solution;
  solution.radiosity = problem.exitance;
  solution.direct_irradiance = transport.apply(problem.exitance);
  solution.irradiance = solution.direct_irradiance;
  solution.trapped = std::move(why);
  solution.history.push_back({.number = 0, .relative_residual = 1, .error_bound = no_bound, .seconds = 0, .work = 1});
  return solution;
}

// The light that patches of a pocket first send to each other arrives as direct irradiance.
Solution solved_around(const TransportOperator& transport, const Pockets& pockets, bool closed_are_dark,
                       RadiosityProblem problem, const SolverOptions& options, const Observer& observer) {
  // Rounding leaves 1e-9 of light that is reflected thousands of times.
  const double accuracy = std::max(1e-9, 0.01 * tolerance_of(options));
  const PocketTransport around(transport, pockets, problem.scattering, closed_are_dark, accuracy);
  const Field within = around.irradiance_within(problem.exitance);
  const Field by_emitters = transport.apply(problem.exitance);
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
  solution.direct_irradiance = by_emitters;
  // A pocket error above the tolerance invalidates all bounds.
  if (around.farthest_off() > tolerance_of(options)) {
    solution.error.resize(0, 0);
    solution.patch_bound = no_bound;
  }
  return solution;
}

// Reports a singular system before any iteration. Such a system has lamps on patches that no light leaves; if pockets
// are known, these patches are all closed. Shooting solvers do not check this, as they do not use the whole transport.
Solution solution_of(const TransportOperator& transport, const RadiosityProblem& problem, const SolverOptions& options,
                     const Observer& observer) {
  const Scattering& scattering = problem.scattering;
  const Pockets* const pockets =
      scattering.is_diagonal() ? transport.pockets(scattering.reflectance.rowwise().maxCoeff()) : nullptr;
  const bool closed_are_dark = pockets != nullptr && !(chosen_rows(problem.exitance, pockets->closed) > 0).any();
  const bool known = !options.largest_row_sum || std::isfinite(*options.largest_row_sum);
  std::string trapped = known && !closed_are_dark ? trapped_light(transport, problem) : std::string();
  if (!trapped.empty()) return lamps_alone(transport, problem, std::move(trapped));
  if (pockets != nullptr) return solved_around(transport, *pockets, closed_are_dark, problem, options, observer);
  return solution_by(options.solver, Iterations(transport, problem, options, observer), transport.rows());
}

}  // namespace

std::vector<Solver> all_solvers() {
  std::vector<Solver> all;
  for (std::size_t k = 0; k < solver_names.size(); ++k) all.push_back(static_cast<Solver>(k));
  return all;
}

const char* name_of(Solver solver) { return solver_names.at(static_cast<std::size_t>(solver)); }

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
  const Eigen::ArrayXd rounded = 1e-14 * area_norm(reference, problem.area);
  double worst = 0;
  for (Eigen::Index band = 0; band < error.size(); ++band) {
    // 0 / 0 is 0 here, up to rounding. NaN is the worst band.
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

  require_rows(transport, options.solver);
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
  solution.direct_irradiance = irradiance_by_emitters(transport, problem.exitance) + problem.direct_irradiance;
  return solution;
}

}  // namespace patchlight
