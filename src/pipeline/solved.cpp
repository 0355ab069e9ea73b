#include "pipeline/solved.h"

#include "patchlight/accuracy/error_bars.h"
#include "patchlight/base/error.h"
#include "patchlight/solve/problem.h"
#include "patchlight/transport/lost_share.h"

#include "accuracy/errors.h"
#include "accuracy/spaces.h"
#include "base/parallel.h"
#include "base/tolerances.h"
#include "base/vectors.h"
#include "pipeline/radiosity_errors.h"
#include "pipeline/solve_with_rays.h"
#include "solve/scattering.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// H = F E + H_direct; B = E + rho o H.
Solution solve_direct_light(const RowTransport& transport, const RadiosityProblem& problem, const Observer& observer) {
  const double start = wall_seconds();
  Field H = irradiance_by_emitters(transport, problem.exitance, observer);
  if (problem.direct_irradiance.size() > 0) H += problem.direct_irradiance;
  Solution solution = reflected_once(problem, std::move(H));
  const auto rows = (problem.exitance > 0).rowwise().any().count();
  solution.history = {{.seconds = wall_seconds() - start,
                       .work = static_cast<double>(rows) / static_cast<double>(problem.exitance.rows())}};
  const Progress last{.stage = Stage::solve, .fraction = 1, .iteration = &solution.history[0], .irradiance = [&] {
                        return solution.irradiance;
                      }};
  if (observer && !observer(last)) throw Canceled();
  return solution;
}

// Solves with some options.
using Solve = std::function<Solution(const SolverOptions& options)>;

// A solution and the relative error requested of the solver.
struct SolvedWith {
  Solution solution;
  double relative_error = 0;
};

// Solves, and reduces the relative error until the solver's part of the error of interest is at most
// AccuracyOptions::solver_part. A bound relative to all light hardly limits the error in a dim room. Returns the last
// solution that has converged. `simulation` has the plan, the problem and the mesh.
SolvedWith solve_for_interest(const Run& run, const Simulation& simulation, const SolverOptions& by,
                              const Solve& solve) {
  SolverOptions options = by;
  SolvedWith best{solve(options), tolerance_of(options)};
  const std::optional<double>& part = simulation.plan.accuracy.solver_part;
  if (!part || !best.solution.converged) return best;
  const Eigen::VectorXd interest = interest_in(run.scene, simulation);
  for (;;) {
    const SolvedProblem solved{simulation.problem, best.solution};
    const double left = relative_bar(solver_errors(solved), simulation.problem, best.solution, interest);
    // An infinite part has no bound, or no light, whatever the tolerance. No solver gets nearer to rounding.
    if (!(left > *part) || !std::isfinite(left) || best.relative_error <= tolerance_of_arithmetic) return best;
    // Half of the needed error, as the bound of a patch does not fall evenly with the residual, in limited steps.
    options.relative_error =
        std::max(tolerance_of_arithmetic, best.relative_error * std::max(1e-4, 0.5 * *part / left));
    Solution next = solve(options);
    if (!next.converged) return best;
    best = {std::move(next), tolerance_of(options)};
  }
}

// In all bands of a problem. Rows on demand do not outlive the mesh of the run.
SolvedTransport kept_transport(const Plan& plan, const RadiosityProblem& problem, const MeshTransport& transport) {
  SolvedTransport kept{{}, nullptr, problem.scattering, problem.area};
  if (transport.rays) kept.light = transport.rays;
  if (!transport.rays && keeps_entries(plan.assembly.storage)) kept.light = transport.rows;
  for (Eigen::Index band = 0; band < problem.exitance.cols(); ++band) kept.bands.push_back(band);
  return kept;
}

// Where the light of a solution goes. `row_sum` is sum_j F_ij of the transport that was solved with.
EnergyBalance energy_balance(const RadiosityProblem& problem, const Solution& solution, const Eigen::VectorXd& row_sum,
                             const LostShare& lost) {
  const auto flux = [&](const Field& x) { return area_sum(x, problem.area); };
  const Field& B = solution.radiosity;
  const Field& H = solution.irradiance;

  EnergyBalance balance;
  balance.emitted = flux(problem.exitance);
  balance.arriving = Eigen::ArrayXd::Zero(balance.emitted.size());
  if (problem.direct_irradiance.size() > 0) balance.arriving = flux(problem.direct_irradiance);
  balance.absorbed = flux(absorb(problem.scattering, H));
  balance.escaped = flux(B.colwise() * lost.escaped.array());
  balance.lost_at_backs = flux(B.colwise() * lost.at_backs.array());
  // Light that leaves a patch and arrives at no other, beyond the measured lost share.
  balance.defect = flux(B.colwise() * (1 - row_sum.array() - lost.escaped.array() - lost.at_backs.array()));
  const Eigen::ArrayXd all = balance.emitted + balance.arriving;
  const Eigen::ArrayXd left = all - balance.absorbed - balance.escaped - balance.lost_at_backs - balance.defect;
  balance.imbalance = largest((all > 0).select(left.abs() / all, 0.0));
  return balance;
}

// No light is negative. Iterations leave patches slightly below 0 where hardly any light arrives: that is their error.
Solution without_negative_light(Solution solution, const RadiosityProblem& problem) {
  if ((solution.irradiance >= 0).all() && (solution.radiosity >= 0).all()) return solution;
  solution.irradiance = solution.irradiance.max(0.0);
  solution.radiosity = radiosity_from(problem, solution.irradiance);
  return solution;
}

Simulation solved_by_rays(const Run& run, Simulation simulation, const MeshTransport& transport) {
  const TransportFacts& facts = simulation.transport;
  SolverOptions options = simulation.plan.solver;
  options.largest_row_sum = largest(facts.row_sum);
  // Several solutions stand behind one by rays: none of them is one without the others.
  options.keeps_unfinished = false;
  RaySolution found;
  const Solve once = [&](const SolverOptions& by) {
    found = solve_with_rays(run, simulation.mesh, *transport.rays, *transport.light, facts, by);
    return std::move(found.solution);
  };
  SolvedWith best = solve_for_interest(run, simulation, options, once);
  simulation.plan.solver.relative_error = best.relative_error;
  simulation.solution = without_negative_light(std::move(best.solution), simulation.problem);
  simulation.ray_standard_error = std::move(found.standard_error);
  simulation.correlated_errors = std::move(found.correlated_errors);
  simulation.balance = energy_balance(simulation.problem, simulation.solution, facts.row_sum, facts.lost);
  return simulation;
}

}  // namespace

SolveWith solver_as_planned(SolveWith solve, const Plan& plan) {
  if (simulates(plan, Effect::interreflection)) return solve ? std::move(solve) : SolveWith(patchlight::solve);
  return [](const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions&,
            const Observer& observer) { return solve_direct_light(transport, problem, observer); };
}

Simulation solved(const Run& run, const MeshToSolve& meshed, const MeshTransport& transport, LitProblem problem) {
  Simulation simulation;
  simulation.plan = meshed.plan;
  simulation.notes = run.notes;
  simulation.mesh = meshed.mesh.patches;
  simulation.transport = transport.facts;
  simulation.problem = std::move(problem.problem);
  simulation.direct_standard_error = std::move(problem.direct_standard_error);
  simulation.world = run.world;
  if (run.scene.sky || run.scene.sun)
    simulation.enclosed = enclosed_patches(run.scene, run.world->all_faces(), simulation.mesh);
  if (run.with.exchange || run.with.ray_exchange)
    simulation.notes = merged({std::move(simulation.notes), notes_on_hidden_lamps(run.scene, simulation)});
  if (run.with.keeps_transport) simulation.transports = {kept_transport(meshed.plan, simulation.problem, transport)};
  if (transport.rays) return solved_by_rays(run, std::move(simulation), transport);

  const bool keeps = keeps_entries(meshed.plan.assembly.storage);
  const TransportFacts& facts = simulation.transport;
  SolverOptions options = meshed.plan.solver;
  options.largest_row_sum = keeps ? largest(facts.row_sum) : std::numeric_limits<double>::infinity();
  const SolveWith solve = solver_as_planned(run.with.solve, meshed.plan);
  const Observer keeping = [&run](const Progress& progress) {
    if (progress.iteration != nullptr) run.with.keeps_unfinished();  // every iterate is kept
    return !run.observer || run.observer(progress);
  };
  const Observer& observer = options.keeps_unfinished ? keeping : run.observer;
  const Solve once = [&](const SolverOptions& by) { return solve(*transport.rows, simulation.problem, by, observer); };
  SolvedWith found = solve_for_interest(run, simulation, options, once);
  simulation.plan.solver.relative_error = found.relative_error;
  simulation.solution = without_negative_light(std::move(found.solution), simulation.problem);
  simulation.balance = energy_balance(simulation.problem, simulation.solution,
                                      keeps ? facts.row_sum : expected_row_sum(facts.lost), facts.lost);
  return simulation;
}

}  // namespace patchlight
